#include "src/geometry/points_on_line.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {

std::vector<PointOnLine> points_on_line(const Points& points, const Coordinates& from,
                                        const Coordinates& to) {
  return points_on_line(points, from, to, points.own());
}

std::vector<PointOnLine> points_on_line(const Points& points, const Coordinates& from,
                                        const Coordinates& to, Index count) {
  const double length = std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  const double reach = (0.5 + 1e-9) * points.spacing;  // a row half a spacing off counts
  std::vector<PointOnLine> found;
  for (Index point = 0; point < count; ++point) {
    const Coordinates at = points.position(point);
    double along = 0.0;
    for (std::size_t c = 0; c < 3; ++c) along += (at[c] - from[c]) * (to[c] - from[c]) / length;
    const double share = std::clamp(along / length, 0.0, 1.0);
    Coordinates off{};
    for (std::size_t c = 0; c < 3; ++c) off[c] = at[c] - from[c] - share * (to[c] - from[c]);
    if (std::hypot(off[0], off[1], off[2]) <= reach) found.push_back({along, point});
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace peristat
