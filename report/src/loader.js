// Starts the page's program, which the page carries compressed.
import { unzipped } from "./unzipped.js";

unzipped(document.getElementById("program").textContent).then(
  (bytes) => {
    const script = document.createElement("script");
    script.textContent = new TextDecoder().decode(bytes);
    document.body.append(script);
  },
  (error) => document.body.prepend(`The curves and the body need a newer browser: ${error}`),
);
