// The body of a run: its cells, states and broken bonds, over the numbers of the page.

import { BoxCells } from "./box_cells.js";
import { PolygonCells } from "./polygon_cells.js";

export class Body {
  constructor(content, numbers) {
    this.content = content;
    this.dimension = content.dimension;
    this.frames = content.frames;
    this.places = numbers.list("places");
    this.count = this.places.length;
    this.numbers = numbers;
    this.displacement = numbers.field("displacement", this.places);
    this.fields = new Map(content.fields.map((field) => [field.name, numbers.field(field.name, this.places)]));
    this.position = numbers.has("position") ? numbers.field("position", this.places) : null;
    this.centres = this.#centres(Boolean(this.position));
    const ofCells = content.kind === "lattice" ? this.#centres(false) : this.centres; // those of a perturbed lattice stay
    this.cells =
      content.kind === "polygons"
        ? new PolygonCells(numbers, this.places, ofCells)
        : new BoxCells(content, numbers, this.places, ofCells);
    this.points = numbers.has("number") ? numbers.list("number") : null;
    this.bonds = numbers.has("bond_first") ? this.#bonds() : null;
  }

  /** Displacements of a frame, count x 3. */
  displacements(frame) {
    const all = new Float64Array(3 * this.count);
    for (let c = 0; c < this.dimension; c++) {
      this.displacement.values(frame, c).forEach((value, cell) => (all[3 * cell + c] = value));
    }
    return all;
  }

  largestDisplacement() {
    const ends = this.frames.flatMap((_, frame) => [
      ...this.displacement.about.low[frame],
      ...this.displacement.about.high[frame],
    ]);
    return Math.max(0, ...ends.map(Math.abs));
  }

  loose(frame) {
    const damage = this.fields.get("damage");
    if (!damage) return new Uint8Array(this.count);
    return Uint8Array.from(damage.values(frame), (value) => value > this.content.loose);
  }

  /** The cell of a point, or -1. */
  cellOf(point) {
    return this.points ? this.points.indexOf(point) : point < this.count ? point : -1;
  }

  /** Ends of the bonds broken up to a frame, count x 2 x 3. */
  brokenBonds(frame, displacements, scale) {
    if (!this.bonds) return new Float32Array();
    const { first, second, step, image } = this.bonds;
    const last = this.frames[frame].step;
    const ends = [];
    for (let bond = 0; bond < step.length && step[bond] <= last; bond++) {
      for (let c = 0; c < 3; c++) ends.push(this.centres[3 * first[bond] + c] + scale * displacements[3 * first[bond] + c]);
      const kind = image ? image[bond] - 1 : -1;
      for (let c = 0; c < 3; c++) {
        const place = this.centres[3 * second[bond] + c] + scale * displacements[3 * second[bond] + c];
        const mirror = kind < 0 ? 1 : (this.content.images.mirror[kind][c] ?? 1);
        ends.push(kind < 0 ? place : mirror * place + (this.content.images.shift[kind][c] ?? 0));
      }
    }
    return Float32Array.from(ends);
  }

  /** Where the points are, count x 3: as given, or on their lattice. */
  #centres(isGiven) {
    const centres = new Float64Array(3 * this.count);
    const { shape, edges, origin } = this.content;
    for (let cell = 0; cell < this.count; cell++) {
      const index = this.content.kind === "lattice" ? gridIndex(this.places[cell], shape) : [];
      for (let c = 0; c < this.dimension; c++) {
        centres[3 * cell + c] = isGiven
          ? this.position.value(0, c, cell)
          : index.reduce((sum, n, axis) => sum + n * edges[axis][c], origin[c]);
      }
    }
    return centres;
  }

  #bonds() {
    const list = (name) => this.numbers.list(`bond_${name}`);
    return {
      first: list("first"),
      second: list("second"),
      step: list("step"),
      image: this.numbers.has("bond_image") ? list("image") : null,
    };
  }
}

function gridIndex(place, shape) {
  const index = [];
  for (let axis = shape.length - 1; axis >= 0; axis--) {
    index.unshift(place % shape[axis]);
    place = Math.floor(place / shape[axis]);
  }
  return index;
}
