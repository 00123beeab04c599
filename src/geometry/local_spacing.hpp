#pragma once

#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// Spacing around each point: the (mean volume of the points within the radius / cross_section) ^
/// (1/dimension) [m]. The mean hides that elements side by side differ, and shows a grading.
/// Without images.
[[nodiscard]] std::vector<double> local_spacings(const Points& points, double radius);

/// Distance of each point from the nearest other one [m]; infinity for a single point.
[[nodiscard]] std::vector<double> nearest_distances(const Points& points);

/// Ratio of the largest to the least local spacing above which a cloud is graded: one horizon then
/// has few neighbours in its coarse parts, or very many in its fine ones.
inline constexpr double graded_ratio = 2.0;

}  // namespace peristat
