// Cells of a plane cloud or mesh: a polygon per point, which moves with its point.

export class PolygonCells {
  constructor(numbers, places, centres) {
    this.count = places.length;
    this.centres = centres;
    this.shapes = numbers.field("corners", places);
    this.corners = this.shapes.components / 2;
  }

  positions(_frame, displacement, _loose, scale) {
    const places = new Float32Array(this.count * this.corners * 3);
    for (let cell = 0, at = 0; cell < this.count; cell++) {
      for (let corner = 0; corner < this.corners; corner++, at += 3) {
        for (let c = 0; c < 3; c++) {
          const offset = c < 2 ? this.shapes.value(0, 2 * corner + c, cell) : 0;
          places[at + c] = this.centres[3 * cell + c] + offset + scale * displacement[3 * cell + c];
        }
      }
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
}
