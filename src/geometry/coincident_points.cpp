#include "src/geometry/coincident_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace peristat {

/// Points are sorted by coarse cells of four tolerances, once with the cells as they are and once
/// shifted by half a cell in each combination of directions: one of these sortings puts such a pair
/// into one cell. A cell cannot hold many points that are further apart, so this is O(n log n).
std::optional<std::pair<Index, Index>> points_at_one_place(const Points& points, double tolerance) {
  using Key = std::pair<std::array<double, 3>, Index>;
  const int dimension = points.dimension;
  std::vector<Key> keys(points.count());
  for (int shifted = 0; shifted < 1 << dimension; ++shifted) {
    for (Index point = 0; point < points.count(); ++point) {
      const Coordinates place = points.position(point);
      keys[point] = {{}, point};
      for (int c = 0; c < dimension; ++c) {
        const double shift = shifted >> c & 1 ? 0.5 : 0.0;
        keys[point].first[c] = std::floor(place[c] / (4 * tolerance) + shift);
      }
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t a = 0; a < keys.size(); ++a) {
      for (std::size_t b = a + 1; b < keys.size() && keys[b].first == keys[a].first; ++b) {
        const Coordinates one = points.position(keys[a].second);
        const Coordinates other = points.position(keys[b].second);
        double distance = 0.0;
        for (int c = 0; c < 3; ++c) distance = std::max(distance, std::abs(one[c] - other[c]));
        if (distance <= tolerance) return std::pair(keys[a].second, keys[b].second);
      }
    }
  }
  return std::nullopt;
}

}  // namespace peristat
