#pragma once

#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// What their own stretches drive of all bonds, along a line.
[[nodiscard]] std::vector<BondDrive> stretches_along(const Points& points, const Bonds& bonds,
                                                     const StateView& at, const StateLine& line,
                                                     int threads);

}  // namespace peristat
