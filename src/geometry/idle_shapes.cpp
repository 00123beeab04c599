#include "src/geometry/idle_shapes.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {
namespace {

bool takes_whole_cells(const Lattice& lattice) {
  return lattice.volumes == CellVolumes::whole && lattice.arrangement == Arrangement::lattice;
}

/// Finds the intersection of two boxes; true if it is not empty.
bool overlap(const Box& one, const Box& other, int dimension, Box& shared) {
  bool is_any = true;
  for (int c = 0; c < 3; ++c) {
    shared.min[c] = std::max(one.min[c], other.min[c]);
    shared.max[c] = std::min(one.max[c], other.max[c]);
    is_any = is_any && (c >= dimension || shared.min[c] < shared.max[c]);
  }
  return is_any;
}

bool takes_something(const Lattice& lattice, const Solid& before, const Shape& shape) {
  Box shared;
  if (!overlap(before.bounds(), bounds(shape), lattice.dimension, shared)) return false;
  if (!takes_whole_cells(lattice)) return true;
  bool is_any = false;
  const LatticeFrame frame = frame_of(lattice);
  frame.for_each_cell(shared, grid_tolerance, [&](const Cell& cell) {
    if (is_any) return;
    const Coordinates place = frame.position(cell);
    is_any = contains(shape, place) && before.contains(place);
  });
  return is_any;
}

std::string extent_text(const Box& box, int dimension) {
  return place_text(box.min, dimension) + " to " + place_text(box.max, dimension) + " m";
}

}  // namespace

void refuse_idle_shapes(const Lattice& lattice) {
  for (std::size_t k = 1; k < lattice.shapes.size(); ++k) {
    const ShapeStep& step = lattice.shapes[k];
    if (step.action == ShapeStep::Action::add) continue;
    const std::vector<ShapeStep> steps(lattice.shapes.begin(),
                                       lattice.shapes.begin() + std::ptrdiff_t(k));
    const Solid before(lattice.dimension, steps);
    if (takes_something(lattice, before, step.shape)) continue;
    throw InputError("shapes[" + std::to_string(k) + "].action", "",
                     "has no effect: no point of the body lies in this shape, which extends from " +
                         extent_text(bounds(step.shape), lattice.dimension) +
                         "; the body extends from " +
                         extent_text(before.bounds(), lattice.dimension));
  }
}

}  // namespace peristat
