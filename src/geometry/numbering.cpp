#include "src/geometry/numbering.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "src/core/infinity.hpp"

namespace peristat {

LocalityCells::LocalityCells(int dimension, const Spacing& spacing, const Coordinates& low,
                             const Coordinates& high)
    : dimension_(dimension), spacing_(spacing), low_(low) {
  std::stable_sort(directions_.begin(), directions_.begin() + dimension,
                   [&](int a, int b) { return along(high[a], a) > along(high[b], b); });
  if (dimension < 3) return;
  auto& [slowest, second, third] = directions_;
  if (along(high[second], second) > along(high[third], third)) std::swap(second, third);
}

/// Whole numbers, so that round-off does not decide between equal lengths.
double LocalityCells::along(double coordinate, int direction) const {
  // Cells are centred on the lattice's points, which would otherwise lie on cell boundaries.
  return std::floor((coordinate - low_[direction]) / spacing_.along(direction) + 0.5);
}

LocalityCells::Key LocalityCells::of(const double* position) const {
  Key key{};
  for (int c = 0; c < dimension_; ++c) {
    const int direction = directions_[c];
    key[c] = along(position[direction], direction);
  }
  return key;
}

std::vector<Index> locality_order(int dimension, const Spacing& spacing,
                                  const std::vector<double>& reference) {
  const std::size_t count = reference.size() / dimension;
  Coordinates low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (std::size_t k = 0; k < reference.size(); ++k) {
    low[k % dimension] = std::min(low[k % dimension], reference[k]);
    high[k % dimension] = std::max(high[k % dimension], reference[k]);
  }
  const LocalityCells cells(dimension, spacing, low, high);
  struct Place {
    LocalityCells::Key cell{};
    Index point = 0;
    bool operator<(const Place& other) const {
      return cell != other.cell ? cell < other.cell : point < other.point;
    }
  };
  std::vector<Place> places(count);
  for (std::size_t point = 0; point < count; ++point) {
    places[point] = {cells.of(&reference[point * dimension]), static_cast<Index>(point)};
  }
  std::sort(places.begin(), places.end());

  std::vector<Index> order(count);
  std::transform(places.begin(), places.end(), order.begin(),
                 [](const Place& place) { return place.point; });
  return order;
}

Points renumbered(const Points& points, const std::vector<Index>& order) {
  Points result;
  result.dimension = points.dimension;
  result.spacing = points.spacing;
  result.angle = points.angle;
  result.cell_volume = points.cell_volume;
  result.lattice = points.lattice;
  result.reference.reserve(points.reference.size());
  result.volume.reserve(points.volume.size());
  constexpr Index left_out = -1;
  std::vector<Index> new_number(points.volume.size(), left_out);
  for (const Index old : order) {
    new_number[old] = result.count();
    const auto first = points.reference.begin() + std::ptrdiff_t(old) * points.dimension;
    result.reference.insert(result.reference.end(), first, first + points.dimension);
    result.volume.push_back(points.volume[old]);
    if (!points.horizons.empty()) result.horizons.push_back(points.horizons[std::size_t(old)]);
    if (!points.polygons.empty()) result.polygons.append(points.polygons.of(std::size_t(old)));
  }
  for (const auto& [name, values] : points.columns) {
    std::vector<double>& new_values = result.columns[name];
    new_values.reserve(order.size());
    for (const Index old : order) new_values.push_back(values[std::size_t(old)]);
  }
  for (NeighbourShares pair : points.neighbours) {
    pair.i = new_number[pair.i];
    pair.j = new_number[pair.j];
    if (pair.i == left_out || pair.j == left_out) continue;
    if (pair.i > pair.j) {
      std::swap(pair.i, pair.j);
      std::swap(pair.of_i, pair.of_j);
    }
    result.neighbours.push_back(pair);
  }
  std::sort(result.neighbours.begin(), result.neighbours.end(),
            [](const NeighbourShares& a, const NeighbourShares& b) {
              return a.i != b.i ? a.i < b.i : a.j < b.j;
            });
  for (const auto& [name, members] : points.sets) {
    std::vector<Index>& new_members = result.sets[name];
    new_members.reserve(members.size());
    for (const Index old : members) {
      if (new_number[old] != left_out) new_members.push_back(new_number[old]);
    }
    std::sort(new_members.begin(), new_members.end());
  }
  return result;
}

}  // namespace peristat
