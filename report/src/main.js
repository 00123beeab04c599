// The program of a report: curves and the body, from the numbers that the page carries.

import { BodyView } from "./body_view.js";
import { drawCurves } from "./curves.js";
import { Numbers } from "./numbers.js";
import "./styles.css";
import { unzipped } from "./unzipped.js";

async function begin() {
  const content = JSON.parse(document.getElementById("content").textContent);
  const marks = content.curves.map((curve) => drawCurves(document.getElementById(curve.id), curve));
  const place = document.getElementById("body-view");
  if (content.body && place) {
    const bytes = await unzipped(document.getElementById("numbers").textContent);
    const view = new BodyView(place, content.body, new Numbers(bytes, content.body.arrays), (step) =>
      marks.forEach((mark) => mark(step)),
    );
    globalThis.peristat = { view };
  }
  document.documentElement.dataset.ready = "yes";
}

begin().catch((error) => {
  document.querySelector("main").prepend(`The curves and the body can't be shown: ${error.message}`);
  throw error;
});
