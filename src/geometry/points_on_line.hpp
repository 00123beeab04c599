#pragma once

#include <compare>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

struct PointOnLine {
  double distance = 0.0;  ///< from the begin, along the line [m]
  Index point = 0;
  auto operator<=>(const PointOnLine&) const = default;
};

/// Points that stand for themselves within half a spacing of a straight line from one place to
/// another, in their order along it.
[[nodiscard]] std::vector<PointOnLine> points_on_line(const Points& points, const Coordinates& from,
                                                      const Coordinates& to);
/// Of the first `count` points.
[[nodiscard]] std::vector<PointOnLine> points_on_line(const Points& points, const Coordinates& from,
                                                      const Coordinates& to, Index count);

}  // namespace peristat
