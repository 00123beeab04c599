// The values of a point, each with the error that the page's numbers add.

import { element } from "./dom.js";
import { sizeOfError, withUnit } from "./units.js";

const AXES = "xyz";

export function pointTable(body, quantities, cell, frame) {
  const name = body.points ? `point ${body.points[cell]}` : `cell ${cell}, a mean of points`;
  const table = element("table", {}, element("caption", { textContent: `${name}, step ${body.frames[frame].step}` }));
  for (let c = 0; c < body.dimension; c++) {
    const error = body.position?.error(0, c) ?? 0;
    table.append(row(`${AXES[c]} (reference)`, body.centres[3 * cell + c], error, "m", `position_${AXES[c]}`));
  }
  for (const { id, label, unit, at, error } of quantities)
    table.append(row(label, at(frame, cell), error(frame), unit, id));
  return table;
}

function row(label, value, error, unit, id) {
  return element(
    "tr",
    {},
    element("th", { scope: "row", textContent: label }),
    element("td", {
      textContent: withUnit(value, unit, error),
      "data-name": id,
      "data-value": value,
      "data-error": error,
    }),
    element("td", { className: "error", textContent: error > 0 ? `± ${sizeOfError(error, unit)}` : "" }),
  );
}
