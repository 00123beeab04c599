#pragma once

#include <string>
#include <vector>

#include "src/geometry/lattice.hpp"
#include "src/geometry/part.hpp"
#include "src/materials/quadrature.hpp"

namespace peristat::tests {

/// A body to distribute.
struct RanksBody {
  std::string name;
  Lattice lattice;
  double horizon_ratio = 3.015;

  [[nodiscard]] BondSetting setting(VolumeCorrection correction = VolumeCorrection::linear) const {
    const double horizon = horizon_ratio * lattice.spacing;
    return {{lattice.dimension, horizon, lattice.cross_section, correction}, PlaneState::stress};
  }
};

[[nodiscard]] inline Lattice lattice_box(int dimension, const Coordinates& points,
                                         const Coordinates& spacing) {
  Lattice lattice;
  lattice.dimension = dimension;
  lattice.spacing = Spacing(spacing, dimension);
  lattice.cross_section = dimension == 3 ? 1.0 : 0.5;
  Box box;
  for (int c = 0; c < dimension; ++c) {
    box.min[c] = 0.3;
    box.max[c] = 0.3 + points[c] * spacing[c];
  }
  lattice.shapes.push_back({ShapeStep::Action::add, box});
  return lattice;
}

[[nodiscard]] inline RanksBody bar() {
  return {"bar", lattice_box(1, {40, 0, 0}, {0.1, 0.1, 0.1}), 3.015};
}

/// Bar with no more points than there may be ranks.
[[nodiscard]] inline RanksBody three_points() {
  return {"three points", lattice_box(1, {3, 0, 0}, {0.1, 0.1, 0.1}), 1.015};
}

/// Bar whose parts are thinner than the horizon.
[[nodiscard]] inline RanksBody short_bar() {
  return {"short bar", lattice_box(1, {7, 0, 0}, {0.1, 0.1, 0.1}), 3.015};
}

[[nodiscard]] inline RanksBody strip() {
  return {"strip", lattice_box(2, {4, 2, 0}, {0.1, 0.1, 0.1}), 3.015};
}

/// Plate with layers of different depths.
[[nodiscard]] inline RanksBody plate_with_hole() {
  RanksBody body{"plate with a hole", lattice_box(2, {17, 26, 0}, {0.1, 0.1, 0.1}), 3.015};
  body.lattice.shapes.push_back({ShapeStep::Action::subtract, Disk{{1.2, 1.7}, 0.42}});
  body.lattice.layers = {{"below", {1, -1}, 3},
                         {"above", {1, 1}, 2, "x < 1"},
                         {"left", {0, -1}, 2},
                         {"below twice", {1, -1}, 1}};
  return body;
}

/// Plate whose layers make its shorter direction the longest one, along which points are numbered.
[[nodiscard]] inline RanksBody wide_layers() {
  RanksBody body{"wide layers", lattice_box(2, {4, 6, 0}, {0.1, 0.1, 0.1}), 2.015};
  body.lattice.layers = {{"left", {0, -1}, 3}, {"right", {0, 1}, 4}};
  return body;
}

/// Perturbed block with three different spacings.
[[nodiscard]] inline RanksBody block() {
  RanksBody body{"block", lattice_box(3, {7, 6, 8}, {0.1, 0.11, 0.09}), 2.015};
  body.lattice.perturbation = 0.1;
  body.lattice.layers = {{"front", {2, 1}, 2}};
  return body;
}

/// Plate with a hole and layers, on a turned lattice.
[[nodiscard]] inline RanksBody turned_plate() {
  RanksBody body = plate_with_hole();
  body.name = "turned plate";
  body.lattice.angle = 25.0;
  return body;
}

/// Plate whose boundary cuts cells: small parts of cells join their neighbours, and layers contain
/// partial cells.
[[nodiscard]] inline RanksBody cut_plate() {
  RanksBody body = turned_plate();
  body.name = "cut plate";
  body.lattice.volumes = CellVolumes::fractional;
  return body;
}

[[nodiscard]] inline RanksBody cut_block() {
  RanksBody body{"cut block", lattice_box(3, {6.3, 5.4, 7.7}, {0.1, 0.1, 0.1}), 2.015};
  body.lattice.shapes.push_back({ShapeStep::Action::subtract, Sphere{{0.5, 0.5, 0.6}, 0.22}});
  body.lattice.volumes = CellVolumes::fractional;
  body.lattice.layers = {{"front", {2, 1}, 2}, {"left", {0, -1}, 1}};
  return body;
}

[[nodiscard]] inline RanksBody perturbed_cells() {
  RanksBody body = plate_with_hole();
  body.name = "perturbed cells";
  body.lattice.cell_perturbation = 0.2;
  return body;
}

[[nodiscard]] inline RanksBody bar_of_perturbed_cells() {
  RanksBody body = bar();
  body.name = "bar of perturbed cells";
  body.lattice.cell_perturbation = 0.2;
  return body;
}

[[nodiscard]] inline std::vector<RanksBody> all_bodies() {
  return {bar(),         three_points(), short_bar(),       strip(),
          wide_layers(), block(),        plate_with_hole(), turned_plate(),
          cut_plate(),   cut_block(),    perturbed_cells(), bar_of_perturbed_cells()};
}

}  // namespace peristat::tests
