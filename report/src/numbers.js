// The numbers of the page: the inverse of python/peristat/report/packing.py.

export class Numbers {
  constructor(bytes, arrays) {
    this.bytes = bytes;
    this.arrays = arrays;
  }

  has(name) {
    return name in this.arrays;
  }

  /** Whole numbers from 0. */
  list(name) {
    const { at, count } = this.arrays[name];
    const numbers = new Uint32Array(count);
    joinPlanes(this.bytes, at, 4, numbers);
    addUp(numbers, [count], 0);
    return numbers;
  }

  /** Quantised values: frames x components x cells. */
  field(name, places) {
    const about = this.arrays[name];
    const total = about.shape.reduce((product, length) => product * length, 1);
    const numbers = about.bytes === 1 ? new Uint8Array(total) : new Uint16Array(total);
    joinPlanes(this.bytes, about.at, about.bytes, numbers);
    if (about.differences.startsWith("space")) {
      for (let axis = 2; axis < about.shape.length; axis++) addUp(numbers, about.shape, axis);
    }
    if (about.differences.endsWith("time")) addUp(numbers, about.shape, 0);
    return new Field(about, numbers, places);
  }
}

/** Values of all frames, each within half a step of what the run has written. */
export class Field {
  constructor(about, numbers, places) {
    this.about = about;
    this.numbers = numbers;
    this.places = places;
    this.components = about.shape[1];
    this.stride = numbers.length / (about.shape[0] * this.components);
  }

  low(frame, component = 0) {
    return this.about.low[frame][component];
  }

  high(frame, component = 0) {
    return this.about.high[frame][component];
  }

  step(frame, component = 0) {
    return (this.high(frame, component) - this.low(frame, component)) / (2 ** this.about.bits - 1);
  }

  /** Largest error of a value, at half of a step. */
  error(frame, component = 0) {
    return 0.5 * this.step(frame, component);
  }

  value(frame, component, cell) {
    const at = (frame * this.components + component) * this.stride + this.places[cell];
    return this.low(frame, component) + this.numbers[at] * this.step(frame, component);
  }

  values(frame, component = 0) {
    const begin = (frame * this.components + component) * this.stride;
    const low = this.low(frame, component);
    const step = this.step(frame, component);
    return Float64Array.from(this.places, (place) => low + this.numbers[begin + place] * step);
  }
}

function joinPlanes(bytes, at, width, numbers) {
  const count = numbers.length;
  for (let i = 0; i < count; i++) {
    let number = 0;
    for (let plane = width - 1; plane >= 0; plane--) number = (number << 8) | bytes[at + plane * count + i];
    numbers[i] = (number >>> 1) ^ -(number & 1); // the sign is in the lowest bit
  }
}

/** Sums along an axis, modulo the size of the numbers. */
function addUp(numbers, shape, axis) {
  const stride = shape.slice(axis + 1).reduce((product, length) => product * length, 1);
  const length = shape[axis];
  for (let i = 0; i < numbers.length; i++) {
    if (Math.floor(i / stride) % length > 0) numbers[i] += numbers[i - stride];
  }
}
