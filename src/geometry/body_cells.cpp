#include "src/geometry/body_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/core/input_error.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

namespace {

bool has_cut_cell(const Points& points) {
  constexpr double round_off = 1e-9;
  return !points.polygons.empty() ||
         (points.cell_volume > 0.0 && std::ranges::any_of(points.volume, [&](double volume) {
            return std::abs(volume / points.cell_volume - 1.0) > round_off;
          }));
}

}  // namespace

BodyCells::BodyCells(const Points& points, const Communicator& ranks) : of_(points), ranks_(ranks) {
  if (!points.lattice) {
    throw InputError("", "",
                     "needs points on a lattice: points of a file or of blue noise have no sides");
  }
  if (points.angle != 0.0 || !points.spacing.is_square() || has_cut_cell(points)) {
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
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& entry : cells_) last = std::max(last, double(along(entry)));
  last = ranks_.max(last);
  std::vector<Index> row;
  for (const auto& entry : cells_) {
    if (double(along(entry)) == last && !of_.is_image(entry.second)) row.push_back(entry.second);
  }
  double count = double(row.size());
  count = ranks_.sum(count);
  if (count == 0.0) {
    throw InputError("", name(side),
                     "on this side the body continues beyond a plane of symmetry or a period");
  }
  std::sort(row.begin(), row.end());
  return row;
}

std::vector<Side> BodyCells::exposed_sides(std::span<const Index> points) const {
  const Index owned = of_.owned.value_or(of_.own());  // a ghost's neighbours may be missing
  std::vector<double> least(6, std::numeric_limits<double>::infinity());  // of cells, and of -cells
  std::vector<double> is_exposed_there(6, 1.0);  // 2 axis + (1 on the upper side)
  for (const Index point : points) {
    if (point >= owned) continue;
    const LatticeCell at = cell(point);
    const bool is_of_body = this->point(at) == point;
    for (int axis = 0; axis < of_.dimension; ++axis) {
      for (const int sign : {-1, 1}) {
        const auto k = std::size_t(2 * axis + (sign > 0));
        least[k] = std::min(least[k], -sign * double(at[axis]));
        if (!is_of_body || !is_exposed(point, {axis, sign})) is_exposed_there[k] = 0.0;
      }
    }
  }
  least = ranks_.min(least);
  is_exposed_there = ranks_.min(is_exposed_there);
  std::vector<Side> sides;
  for (int axis = 0; axis < of_.dimension; ++axis) {
    const auto lower = std::size_t(2 * axis), upper = lower + 1;
    if (least[lower] != -least[upper]) continue;  // more than one plane
    if (is_exposed_there[lower] > 0.0) sides.push_back({axis, -1});
    if (is_exposed_there[upper] > 0.0) sides.push_back({axis, 1});
  }
  return sides;
}

LatticeCell beside(LatticeCell cell, const Side& side) {
  cell[side.axis] += side.sign;
  return cell;
}

}  // namespace peristat
