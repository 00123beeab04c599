// Numbers with units and their prefixes.

const PREFIXES = [
  ["T", 1e12],
  ["G", 1e9],
  ["M", 1e6],
  ["k", 1e3],
  ["", 1],
  ["m", 1e-3],
  ["µ", 1e-6],
  ["n", 1e-9],
  ["p", 1e-12],
];
const SHOWN = { "J/m3": "J/m³", 1: "" };

/** Prefix and size of the unit in which a value is at least 1. */
export function unitFor(largest, unit) {
  const name = SHOWN[unit] ?? unit;
  if (!name || !(largest >= PREFIXES.at(-1)[1])) return { name, size: 1 };
  const [prefix, size] = PREFIXES.find(([, size]) => largest >= size);
  return { name: prefix + name, size };
}

/** "2.5 nm" */
export function sizeOfError(error, unit) {
  const { name, size } = unitFor(error, unit);
  return `${plain(error / size, 2)}${name && ` ${name}`}`;
}

/** "1.234 mm", with the digits that an error leaves; a value below its error is 0. */
export function withUnit(value, unit, error = 0) {
  const { name, size } = unitFor(Math.max(Math.abs(value), error), unit);
  const known = Math.abs(value) > error ? value : 0;
  const digits = error > 0 && known ? Math.ceil(Math.log10(Math.abs(known) / error)) + 1 : 4;
  return `${plain(known / size, Math.min(Math.max(digits, 2), 8))}${name && ` ${name}`}`;
}

/** A number of few digits: 0.00123, 1.2e-7. */
export function plain(value, digits = 4) {
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  return rounded === 0 || (size >= 1e-4 && size < 1e7) ? String(rounded) : rounded.toExponential();
}
