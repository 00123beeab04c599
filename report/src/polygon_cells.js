// Cells of a plane cloud or mesh: polygons that share corners with the neighbours to which they are joined. The same as
// `CloudCells` of python/peristat/pictures/cloud_cells.py.

const FLAT = 1e-2; // neighbours that lie closer to one line give no gradient

export class PolygonCells {
  constructor(numbers, places, centres) {
    this.count = places.length;
    this.centres = centres;
    const shapes = numbers.field("corners", places);
    this.corners = shapes.components / 2;
    this.offsets = Float64Array.from({ length: 2 * this.corners * this.count }, (_, i) =>
      shapes.value(0, i % shapes.components, Math.floor(i / shapes.components)),
    );
    this.knots = numbers.list("knots");
    this.parted = numbers.field("parted", places);
    this.beyond = this.#neighbours();
  }

  positions(frame, displacement, loose, scale) {
    const moved = this.#moved(frame, displacement, loose);
    this.#average(moved, this.#apart(frame, loose));
    const places = new Float32Array(3 * this.count * this.corners);
    for (let corner = 0; corner < this.count * this.corners; corner++) {
      const cell = Math.floor(corner / this.corners);
      for (let c = 0; c < 2; c++)
        places[3 * corner + c] = this.centres[3 * cell + c] + this.offsets[2 * corner + c] + scale * moved[2 * corner + c];
    }
    return places;
  }

  triangles(_frame, isHidden) {
    const found = [];
    for (let cell = 0; cell < this.count; cell++) {
      if (isHidden(cell)) continue;
      const first = cell * this.corners;
      for (let corner = 1; corner < this.corners - 1; corner++) found.push(first, first + corner, first + corner + 1);
    }
    return found;
  }

  /** The cell beyond the side that begins at each corner, or -1. */
  #neighbours() {
    const beyond = new Int32Array(this.knots.length).fill(-1);
    const sides = new Map();
    for (let corner = 0; corner < beyond.length; corner++) {
      const ends = [this.knots[corner], this.knots[this.#after(corner)]];
      if (ends[0] === ends[1]) continue;
      const key = Math.min(...ends) * 2 ** 26 + Math.max(...ends);
      const other = sides.get(key);
      if (other === undefined) sides.set(key, corner);
      else [beyond[corner], beyond[other]] = [Math.floor(other / this.corners), Math.floor(corner / this.corners)];
    }
    return beyond;
  }

  #after(corner) {
    return corner % this.corners === this.corners - 1 ? corner - this.corners + 1 : corner + 1;
  }

  #isParted(frame, corner) {
    return this.parted.value(0, corner % this.corners, Math.floor(corner / this.corners)) <= frame;
  }

  /** Displacements of corners, extrapolated from the points. */
  #moved(frame, displacement, loose) {
    const moved = new Float64Array(2 * this.knots.length);
    for (let cell = 0; cell < this.count; cell++) {
      const gradient = this.#gradient(frame, cell, displacement, loose);
      for (let corner = cell * this.corners; corner < (cell + 1) * this.corners; corner++) {
        for (let c = 0; c < 2; c++) {
          moved[2 * corner + c] =
            displacement[3 * cell + c] +
            gradient[c][0] * this.offsets[2 * corner] +
            gradient[c][1] * this.offsets[2 * corner + 1];
        }
      }
    }
    return moved;
  }

  /** Displacement gradient, component x direction, by least squares over joined neighbours. */
  #gradient(frame, cell, displacement, loose) {
    let [xx, xy, yy] = [0, 0, 0];
    const sums = [
      [0, 0],
      [0, 0],
    ];
    for (let corner = cell * this.corners; corner < (cell + 1) * this.corners; corner++) {
      const other = this.beyond[corner];
      if (other < 0 || loose[cell] || loose[other] || this.#isParted(frame, corner)) continue;
      const apart = [0, 1].map((c) => this.centres[3 * other + c] - this.centres[3 * cell + c]);
      xx += apart[0] ** 2;
      xy += apart[0] * apart[1];
      yy += apart[1] ** 2;
      for (let c = 0; c < 2; c++) {
        const change = displacement[3 * other + c] - displacement[3 * cell + c];
        for (let axis = 0; axis < 2; axis++) sums[c][axis] += change * apart[axis];
      }
    }
    const determinant = xx * yy - xy * xy;
    if (!(determinant > FLAT * (xx + yy) ** 2))
      return [
        [0, 0],
        [0, 0],
      ];
    return sums.map(([x, y]) => [(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant]);
  }

  /** Knots at which cells do not move together. */
  #apart(frame, loose) {
    const apart = new Set();
    for (let corner = 0; corner < this.knots.length; corner++) {
      if (loose[Math.floor(corner / this.corners)]) apart.add(this.knots[corner]);
      if (this.#isParted(frame, corner)) apart.add(this.knots[corner]).add(this.knots[this.#after(corner)]);
    }
    return apart;
  }

  #average(moved, apart) {
    const sums = new Map();
    this.knots.forEach((knot, corner) => {
      if (apart.has(knot)) return;
      const sum = sums.get(knot) ?? [0, 0, 0];
      sums.set(knot, [sum[0] + moved[2 * corner], sum[1] + moved[2 * corner + 1], sum[2] + 1]);
    });
    this.knots.forEach((knot, corner) => {
      const sum = sums.get(knot);
      if (sum) [moved[2 * corner], moved[2 * corner + 1]] = [sum[0] / sum[2], sum[1] / sum[2]];
    });
  }
}
