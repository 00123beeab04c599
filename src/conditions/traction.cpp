#include "src/conditions/traction.hpp"

#include <algorithm>
#include <cmath>

#include "src/conditions/loaded_facets.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/body_cells.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// A part of a cell below this is round-off of the horizon's end.
constexpr double least_part = 1e-9;

struct Face {
  std::vector<Index> row;
  Side side;
};

Face face_of(const Points& points, const BodyCells& cells, const LoadSpecification& load,
             const std::string& key) {
  if (load.side && load.side->axis >= points.dimension) {
    throw InputError(key + ".side", name(*load.side), "the body has no such side");
  }
  if (load.set.empty() && !load.side) throw InputError(key, "", "needs a side or a set");
  if (load.set.empty()) return {cells.outermost(*load.side), *load.side};
  const std::vector<Index>& row = points_of_set(points, load.set, key + ".set");
  std::vector<Side> sides = cells.exposed_sides(row);
  if (load.side) {
    std::erase_if(sides, [&](const Side& side) { return name(side) != name(*load.side); });
  }
  if (sides.size() == 1) return {row, sides.front()};
  const std::string set = '"' + load.set + '"';
  if (!sides.empty()) {
    throw InputError(key + ".set", set,
                     "lies on more than one side of the body; give the side, too");
  }
  throw InputError(key + ".set", set,
                   "a traction acts on a flat part of the boundary, but the points of this set do "
                   "not form one plane of points that is the outermost one on " +
                       (load.side ? "side " + name(*load.side) : "one side") +
                       "; select the outermost row only, or use a pressure for a curved boundary");
}

}  // namespace

TractionAreas traction_areas(const Points& points, const LoadSpecification& load, double horizon,
                             const std::string& key, const Communicator& ranks) {
  if (points.mesh) return facet_areas(points, load, key);
  const BodyCells cells(points, ranks);
  const auto [row, side] = face_of(points, cells, load, key);
  const Index owned = points.owned.value_or(points.own());
  const double depth = load.depth == Depth::row ? 1.0 : std::max(1.0, horizon / points.spacing);
  TractionAreas areas;
  for (const Index outermost : row) {
    const std::size_t first = areas.points.size();
    double whole = 0.0;
    LatticeCell cell = cells.cell(outermost);
    for (double above = 0.0; depth - above > least_part; above += 1.0) {
      const Index point = cells.point(cell);
      if (point < 0) break;
      if (points.is_image(point)) {
        throw InputError(key + ".depth", "\"horizon\"",
                         "the horizon below this side reaches beyond a plane of symmetry or a "
                         "period; take \"row\"");
      }
      areas.points.push_back(point);
      areas.area.push_back(std::min(1.0, depth - above));
      whole += areas.area.back();
      cell = beside(cell, {side.axis, -side.sign});
    }
    const double area = points.volume[outermost] / points.spacing;
    std::size_t kept = first;
    for (std::size_t k = first; k < areas.area.size(); ++k) {
      if (areas.points[k] >= owned) continue;  // the owner has a ghost's part
      areas.points[kept] = areas.points[k];
      areas.area[kept++] = areas.area[k] * (area / whole);
    }
    areas.points.resize(kept);
    areas.area.resize(kept);
  }
  return areas;
}

}  // namespace peristat
