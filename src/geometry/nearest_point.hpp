#pragma once

#include "src/geometry/points.hpp"

namespace peristat {

struct NearestPoint {
  Index point = 0;
  double distance = 0.0;  ///< [m]
};

/// The point that stands for itself and is nearest to a place; of those as near but for round-off
/// the one with the lowest number, on every machine.
[[nodiscard]] NearestPoint nearest_point(const Points& points, const Coordinates& place);
/// Of the first `count` points; infinitely far without one.
[[nodiscard]] NearestPoint nearest_point(const Points& points, const Coordinates& place,
                                         Index count);

/// Distances that differ by less are the same but for round-off [m].
[[nodiscard]] double round_off_of_distances(const Points& points);

}  // namespace peristat
