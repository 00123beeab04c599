#include "src/geometry/numbering.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace peristat {

std::vector<Index> locality_order(int dimension, const Spacing& spacing,
                                  const std::vector<double>& reference) {
  const std::size_t count = reference.size() / dimension;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Coordinates low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (std::size_t k = 0; k < reference.size(); ++k) {
    low[k % dimension] = std::min(low[k % dimension], reference[k]);
    high[k % dimension] = std::max(high[k % dimension], reference[k]);
  }

  // Numbers of cells per direction; whole, so that round-off does not decide between equal lengths.
  const auto cell = [&](double coordinate, int direction) {
    // Cells are centred on the lattice's points, which would otherwise lie on cell boundaries.
    return std::floor((coordinate - low[direction]) / spacing.along(direction) + 0.5);
  };
  std::array<int, 3> directions{0, 1, 2};
  std::stable_sort(directions.begin(), directions.begin() + dimension,
                   [&](int a, int b) { return cell(high[a], a) > cell(high[b], b); });

  struct Key {
    std::array<double, 3> cell{};  // slowest direction first; double, so that nothing overflows
    Index point = 0;
    bool operator<(const Key& other) const {
      return cell != other.cell ? cell < other.cell : point < other.point;
    }
  };
  std::vector<Key> keys(count);
  for (std::size_t point = 0; point < count; ++point) {
    keys[point].point = static_cast<Index>(point);
    for (int c = 0; c < dimension; ++c) {
      const int direction = directions[c];
      keys[point].cell[c] = cell(reference[point * dimension + direction], direction);
    }
  }
  std::sort(keys.begin(), keys.end());

  std::vector<Index> order(count);
  std::transform(keys.begin(), keys.end(), order.begin(), [](const Key& key) { return key.point; });
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
  std::vector<Index> new_number(order.size());
  for (const Index old : order) {
    new_number[old] = result.count();
    const auto first = points.reference.begin() + std::ptrdiff_t(old) * points.dimension;
    result.reference.insert(result.reference.end(), first, first + points.dimension);
    result.volume.push_back(points.volume[old]);
    if (!points.polygons.empty()) result.polygons.append(points.polygons.of(std::size_t(old)));
  }
  for (NeighbourShares pair : points.neighbours) {
    pair.i = new_number[pair.i];
    pair.j = new_number[pair.j];
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
    for (const Index old : members) new_members.push_back(new_number[old]);
    std::sort(new_members.begin(), new_members.end());
  }
  return result;
}

}  // namespace peristat
