#pragma once

#include <compare>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

struct PointOnLine {
  double distance = 0.0;  ///< along the line from its beginning [m]
  Index point = 0;
  auto operator<=>(const PointOnLine&) const = default;
};

/// Points, without images, within half a spacing of a straight line from one place to another, in
/// their order along it.
[[nodiscard]] std::vector<PointOnLine> points_on_line(const Points& points, const Coordinates& from,
                                                      const Coordinates& to);
/// The same among the first `count` points.
[[nodiscard]] std::vector<PointOnLine> points_on_line(const Points& points, const Coordinates& from,
                                                      const Coordinates& to, Index count);

}  // namespace peristat
