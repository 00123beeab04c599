// Numbers with units and their prefixes.

const PREFIXES = [["T", 1e12], ["G", 1e9], ["M", 1e6], ["k", 1e3], ["", 1], ["m", 1e-3], ["µ", 1e-6], ["n", 1e-9], ["p", 1e-12]];
const SHOWN = { "J/m3": "J/m³", 1: "" };

/** Prefix and size of the unit in which a value is at least 1. */
export function unitFor(largest, unit) {
  const name = SHOWN[unit] ?? unit;
  if (!name || !(largest >= PREFIXES.at(-1)[1])) return { name, size: 1 };
  const [prefix, size] = PREFIXES.find(([, size]) => largest >= size);
  return { name: prefix + name, size };
}

/** "1.234 mm"; more digits if an error is given that is smaller. */
export function withUnit(value, unit, error = 0) {
  const { name, size } = unitFor(Math.abs(value), unit);
  const digits = error > 0 && value !== 0 ? Math.ceil(Math.log10(Math.abs(value) / error)) + 1 : 4;
  return `${plain(value / size, Math.min(Math.max(digits, 2), 8))}${name && ` ${name}`}`;
}

/** A number of few digits: 0.00123, 1.2e-7. */
export function plain(value, digits = 4) {
  if (value === 0) return "0";
  const text = value.toPrecision(digits);
  return text.includes("e") || Math.abs(value) < 1e-4 ? value.toExponential(digits - 1).replace(/\.?0+e/, "e") : trimmed(text);
}

function trimmed(text) {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}
