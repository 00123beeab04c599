#pragma once

#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// Edge of the square or cube that a point's volume fills, h_i = (V_i / cross-section)^(1/d) [m].
[[nodiscard]] double size_of_point(const Points& points, Index point, double cross_section);

/// Horizon of each point as a multiple of its size, delta_i = ratio h_i [m].
[[nodiscard]] std::vector<double> horizons_of_sizes(const Points& points, double ratio,
                                                    double cross_section);

/// Largest horizon of the points [m]; 0 without any.
[[nodiscard]] double largest_horizon(const Points& points);

/// Mean of horizon / size over the points: their number of neighbours is that of a lattice with
/// this ratio.
[[nodiscard]] double mean_horizon_ratio(const Points& points, double cross_section);

}  // namespace peristat
