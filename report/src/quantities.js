// What the body can be coloured by, and what a point tells: fields, the displacement and its components.

const AXES = "xyz";

/** Each with its values of a frame, that of a cell, their range and the error that the page adds. */
export function quantitiesOf(body) {
  const { displacement, dimension } = body;
  const axes = [...AXES].slice(0, dimension);
  const made = body.content.fields.map(({ name, label, unit }) => {
    const field = body.fields.get(name);
    const isSigned = field.about.low.some(([low]) => low < 0);
    return withUsual({
      id: name,
      label,
      unit,
      map: name === "damage" ? "damage" : isSigned ? "signed" : "plain",
      values: (frame) => field.values(frame),
      at: (frame, cell) => field.value(frame, 0, cell),
      low: (frame) => field.low(frame),
      high: (frame) => field.high(frame),
      error: (frame) => (name === "fragment" && body.content.is_whole ? 0 : field.error(frame)),
    });
  });
  const length = (frame, cell) => Math.hypot(...axes.map((_, c) => displacement.value(frame, c, cell)));
  const lengths = remembered((frame) => Float64Array.from({ length: body.count }, (_, cell) => length(frame, cell)));
  made.push(
    withUsual({
      id: "displacement",
      label: "displacement",
      unit: "m",
      map: "plain",
      values: lengths,
      at: length,
      low: (frame) => lengths(frame).reduce((a, b) => Math.min(a, b), Infinity),
      high: (frame) => lengths(frame).reduce((a, b) => Math.max(a, b), 0),
      error: (frame) => Math.hypot(...axes.map((_, c) => displacement.error(frame, c))),
    }),
  );
  axes.forEach((axis, c) => {
    made.push(
      withUsual({
        id: `displacement_${axis}`,
        label: `displacement in ${axis}`,
        unit: "m",
        map: "signed",
        values: (frame) => displacement.values(frame, c),
        at: (frame, cell) => displacement.value(frame, c, cell),
        low: (frame) => displacement.low(frame, c),
        high: (frame) => displacement.high(frame, c),
        error: (frame) => displacement.error(frame, c),
      }),
    );
  });
  return made;
}

/** Adds the 99.5th percentile of each frame. */
function withUsual(quantity) {
  return {
    ...quantity,
    usual: remembered((frame) => {
      const sorted = quantity.values(frame).slice().sort();
      return sorted[Math.floor(0.995 * (sorted.length - 1))];
    }),
  };
}

function remembered(compute) {
  const known = new Map();
  return (key) => {
    if (!known.has(key)) known.set(key, compute(key));
    return known.get(key);
  };
}
