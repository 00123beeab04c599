// Cells of a lattice: squares and cubes that share corners with the neighbours to which they are joined. The same as
// `Cells` of python/peristat/pictures/cells.py. Points without a lattice have a box each, without neighbours.

const ROUND = [0, 2, 3, 1]; // corners of a square in circular order
const FACES = [
  // axis, sign, corners in the order that makes the normal point outwards
  [0, -1, [0, 1, 3, 2]],
  [0, 1, [4, 6, 7, 5]],
  [1, -1, [0, 4, 5, 1]],
  [1, 1, [2, 3, 7, 6]],
  [2, -1, [0, 2, 6, 4]],
  [2, 1, [1, 5, 7, 3]],
];

export class BoxCells {
  /**
   * @param content what the page says about the body; a bar is a row of squares
   * @param places of the cells in the grid
   * @param centres count x 3
   */
  constructor(content, numbers, places, centres) {
    this.count = places.length;
    this.isLattice = content.kind === "lattice";
    this.dimension = Math.max(content.dimension, 2);
    this.corners = 2 ** this.dimension;
    this.centres = centres;
    this.edges = edgesOf(content, this.dimension);
    this.offsets = this.isLattice && numbers.has("offsets") ? numbers.field("offsets", places) : null;
    this.parted = this.isLattice ? numbers.field("parted", places) : null;
    this.next = this.isLattice ? nextCells(content.shape, places) : [];
  }

  /** The neighbour after and before each cell along an axis to which it is joined, or -1. */
  joined(axis, frame) {
    const after = new Int32Array(this.count).fill(-1);
    const before = new Int32Array(this.count).fill(-1);
    if (axis < this.next.length) {
      for (let cell = 0; cell < this.count; cell++) {
        const other = this.next[axis][cell];
        if (other < 0 || this.parted.value(0, axis, cell) <= frame) continue;
        after[cell] = other;
        before[other] = cell;
      }
    }
    return { after, before };
  }

  /** Displaced corners, count x corners x 3. Loose cells move with their point alone. */
  positions(frame, displacement, loose, scale) {
    const { count, corners, dimension } = this;
    const links = Array.from({ length: dimension }, (_, axis) => this.joined(axis, frame));
    const moved = this.#moved(displacement, loose, links);
    average(moved, this.#knots(loose, links));
    const places = new Float32Array(count * corners * 3);
    for (let cell = 0, at = 0; cell < count; cell++) {
      for (let corner = 0; corner < corners; corner++, at += 3) {
        for (let c = 0; c < 3; c++) {
          let place = this.centres[3 * cell + c] + scale * moved[at + c];
          for (let axis = 0; axis < dimension; axis++) place += this.#offset(cell, corner, axis) * this.edges[axis][c];
          places[at + c] = place;
        }
      }
    }
    return places;
  }

  /** Corners of the triangles to draw: of squares all, of cubes the faces that are exposed. */
  triangles(frame, isHidden) {
    const found = [];
    const { corners } = this;
    const add = (cell, [a, b, c, d]) => {
      const first = cell * corners;
      found.push(first + a, first + b, first + c, first + a, first + c, first + d);
    };
    if (this.dimension === 2) {
      for (let cell = 0; cell < this.count; cell++) if (!isHidden(cell)) add(cell, ROUND);
      return found;
    }
    const links = [0, 1, 2].map((axis) => this.joined(axis, frame));
    for (const [axis, sign, face] of FACES) {
      const neighbour = sign > 0 ? links[axis].after : links[axis].before;
      for (let cell = 0; cell < this.count; cell++) {
        if (!isHidden(cell) && (neighbour[cell] < 0 || isHidden(neighbour[cell]))) add(cell, face);
      }
    }
    return found;
  }

  #offset(cell, corner, axis) {
    if (this.offsets) return this.offsets.value(0, corner * this.dimension + axis, cell);
    return isHigh(corner, axis, this.dimension) ? 0.5 : -0.5;
  }

  /** Displacements of corners, extrapolated from the points. */
  #moved(displacement, loose, links) {
    const { count, corners, dimension } = this;
    const moved = new Float32Array(count * corners * 3);
    const change = new Float64Array(dimension * 3);
    for (let cell = 0; cell < count; cell++) {
      change.fill(0);
      for (let axis = 0; axis < dimension; axis++) {
        const others = [links[axis].after[cell], links[axis].before[cell]];
        const usable = others.filter((other) => other >= 0 && !loose[cell] && !loose[other]).length;
        others.forEach((other, side) => {
          if (other < 0 || loose[cell] || loose[other]) return;
          for (let c = 0; c < 3; c++) {
            const difference = displacement[3 * other + c] - displacement[3 * cell + c];
            change[3 * axis + c] += (side ? -difference : difference) / usable;
          }
        });
      }
      for (let corner = 0; corner < corners; corner++) {
        for (let c = 0; c < 3; c++) {
          let value = displacement[3 * cell + c];
          for (let axis = 0; axis < dimension; axis++) value += this.#offset(cell, corner, axis) * change[3 * axis + c];
          moved[(cell * corners + corner) * 3 + c] = value;
        }
      }
    }
    return moved;
  }

  /** A number per corner, which joined cells share at their common corners. */
  #knots(loose, links) {
    const { count, corners, dimension } = this;
    const parent = Int32Array.from({ length: count * corners }, (_, i) => i);
    const root = (i) => {
      while (parent[i] !== i) i = parent[i] = parent[parent[i]];
      return i;
    };
    links.forEach(({ after }, axis) => {
      const bit = corners >> (axis + 1);
      for (let cell = 0; cell < count; cell++) {
        const other = after[cell];
        if (other < 0 || loose[cell] || loose[other]) continue;
        for (let corner = 0; corner < corners; corner++) {
          if (!isHigh(corner, axis, dimension)) continue;
          parent[root(cell * corners + corner)] = root(other * corners + corner - bit);
        }
      }
    });
    return parent.map((_, i) => root(i));
  }
}

function isHigh(corner, axis, dimension) {
  return (corner >> (dimension - 1 - axis)) & 1;
}

function average(moved, knots) {
  const sums = new Float64Array(moved.length);
  const number = new Uint16Array(knots.length);
  knots.forEach((knot, i) => {
    number[knot]++;
    for (let c = 0; c < 3; c++) sums[3 * knot + c] += moved[3 * i + c];
  });
  knots.forEach((knot, i) => {
    for (let c = 0; c < 3; c++) moved[3 * i + c] = sums[3 * knot + c] / number[knot];
  });
}

function edgesOf(content, dimension) {
  const given = content.edges ?? Array.from({ length: content.dimension }, (_, axis) => unit(axis, 0.8 * content.mark));
  const edges = given.map((edge) => [...edge, 0, 0].slice(0, 3));
  if (edges.length < dimension) edges.push([0, Math.max(edges[0][0], content.size / 40), 0]); // a bar
  return edges;
}

function unit(axis, length) {
  return [0, 1, 2].map((c) => (c === axis ? length : 0));
}

/** The next cell along each axis of the grid, or -1. */
function nextCells(shape, places) {
  const cellAt = new Map(Array.from(places, (place, cell) => [place, cell]));
  return shape.map((length, axis) => {
    const stride = shape.slice(axis + 1).reduce((product, n) => product * n, 1);
    return Int32Array.from(places, (place) =>
      Math.floor(place / stride) % length < length - 1 ? (cellAt.get(place + stride) ?? -1) : -1,
    );
  });
}
