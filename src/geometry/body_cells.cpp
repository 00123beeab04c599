#include "src/geometry/body_cells.hpp"

#include <algorithm>
#include <cmath>

#include "src/core/input_error.hpp"

namespace peristat {

BodyCells::BodyCells(const Points& points) : of_(points) {
  if (!points.lattice) {
    throw InputError("", "",
                     "needs points on a lattice: those of a file and of blue noise have no sides");
  }
  if (points.angle != 0.0 || !points.spacing.is_square() || points.cell_volume > 0.0) {
    throw InputError("", "",
                     "needs whole square or cubic cells along the axes: no angle, one spacing, and "
                     "volumes = \"cells\"");
  }
  std::vector<char> is_outside(std::size_t(points.own()), 0);
  for (const std::string& layer : points.lattice->layers) {
    for (const Index point : points.sets.at(layer)) is_outside[point] = 1;
  }
  for (Index i = 0; i < points.count(); ++i) {
    const Index own = points.is_image(i) ? points.source(i) : i;
    if (!is_outside[own]) cells_.emplace_back(cell(i), i);
  }
  std::sort(cells_.begin(), cells_.end());
}

LatticeCell BodyCells::cell(Index point) const {
  const Coordinates at = of_.position(point);
  LatticeCell cell{};
  for (int c = 0; c < of_.dimension; ++c) {
    cell[c] = std::llround((at[c] - of_.lattice->origin[c]) / of_.spacing);
  }
  return cell;
}

Index BodyCells::point(const LatticeCell& cell) const {
  const auto found = std::lower_bound(cells_.begin(), cells_.end(), std::pair(cell, Index(-1)));
  return found != cells_.end() && found->first == cell ? found->second : Index(-1);
}

bool BodyCells::is_exposed(Index point, const Side& side) const {
  return this->point(beside(cell(point), side)) < 0;
}

std::vector<Index> BodyCells::outermost(const Side& side) const {
  const auto along = [&](const auto& entry) { return side.sign * entry.first[side.axis]; };
  const auto last =
      std::max_element(cells_.begin(), cells_.end(),
                       [&](const auto& a, const auto& b) { return along(a) < along(b); });
  std::vector<Index> row;
  for (const auto& entry : cells_) {
    if (along(entry) == along(*last) && !of_.is_image(entry.second)) row.push_back(entry.second);
  }
  if (row.empty()) {
    throw InputError("", name(side), "on this side the body goes on beyond a plane or period");
  }
  std::sort(row.begin(), row.end());
  return row;
}

std::vector<Side> BodyCells::exposed_sides(std::span<const Index> points) const {
  std::vector<Side> sides;
  for (int axis = 0; axis < of_.dimension; ++axis) {
    for (const int sign : {-1, 1}) {
      const Side side{axis, sign};
      if (std::all_of(points.begin(), points.end(), [&](Index point) {
            return cell(point)[axis] == cell(points.front())[axis] &&
                   this->point(cell(point)) == point && is_exposed(point, side);
          })) {
        sides.push_back(side);
      }
    }
  }
  return sides;
}

LatticeCell beside(LatticeCell cell, const Side& side) {
  cell[side.axis] += side.sign;
  return cell;
}

}  // namespace peristat
