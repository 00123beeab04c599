#include "src/geometry/nearest_point.hpp"

#include <cmath>
#include <limits>

namespace peristat {

NearestPoint nearest_point(const Points& points, const Coordinates& place) {
  const double slack = 1e-9 * points.spacing;
  NearestPoint nearest{0, std::numeric_limits<double>::infinity()};
  for (Index point = 0; point < points.own(); ++point) {
    const Coordinates at = points.position(point);
    const double distance = std::hypot(at[0] - place[0], at[1] - place[1], at[2] - place[2]);
    if (distance < nearest.distance - slack) nearest = {point, distance};
  }
  return nearest;
}

}  // namespace peristat
