#include "src/geometry/nearest_point.hpp"

#include <cmath>
#include <limits>

namespace peristat {

double round_off_of_distances(const Points& points) { return 1e-9 * points.spacing; }

NearestPoint nearest_point(const Points& points, const Coordinates& place) {
  return nearest_point(points, place, points.own());
}

NearestPoint nearest_point(const Points& points, const Coordinates& place, Index count) {
  const double slack = round_off_of_distances(points);
  NearestPoint nearest{0, std::numeric_limits<double>::infinity()};
  for (Index point = 0; point < count; ++point) {
    const Coordinates at = points.position(point);
    const double distance = std::hypot(at[0] - place[0], at[1] - place[1], at[2] - place[2]);
    if (distance < nearest.distance - slack) nearest = {point, distance};
  }
  return nearest;
}

}  // namespace peristat
