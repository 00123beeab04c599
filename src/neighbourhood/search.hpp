#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// All unique bonds no longer than `radius` [m] (up to horizon_tolerance), found with a cell list
/// in time proportional to their number. Lengths are filled in; weights are left at zero, for
/// `make_bonds` to set. The result does not depend on the number of threads.
[[nodiscard]] Bonds search_bonds(const Points& points, double radius, int threads);

/// All unique bonds no longer than the larger radius of their two points, likewise. Points are
/// sorted into levels of nearly equal radii, so that the time stays proportional to the number of
/// bonds.
/// @param radii per point [m]
[[nodiscard]] Bonds search_bonds(const Points& points, std::span<const double> radii, int threads);

/// Numbers of neighbours within `radius` of the first points, without finding bonds.
[[nodiscard]] std::vector<std::int32_t> count_neighbours(const Points& points, Index first,
                                                         double radius, int threads);

}  // namespace peristat
