#pragma once

#include "src/geometry/points.hpp"

namespace peristat {

struct NearestPoint {
  Index point = 0;
  double distance = 0.0;  ///< [m]
};

/// Point nearest to a place, images excluded; of points as near within round-off the one with the
/// lowest number, on every machine.
[[nodiscard]] NearestPoint nearest_point(const Points& points, const Coordinates& place);
/// Nearest of the first `count` points; infinitely far without one.
[[nodiscard]] NearestPoint nearest_point(const Points& points, const Coordinates& place,
                                         Index count);

/// Distances that differ by less than this are equal within round-off [m].
[[nodiscard]] double round_off_of_distances(const Points& points);

}  // namespace peristat
