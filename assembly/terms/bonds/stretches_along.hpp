#pragma once

#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// A line of states: the direction of the displacements, with the rate of the eigenstretches.
struct Line {
  std::span<const double> rate{}, eigenstretch_rate{};
};

/// Stretches of all bonds and their rates along a line, without what drives them.
[[nodiscard]] std::vector<BondDrive> stretches_along(const Points& points, const Bonds& bonds,
                                                     const StateView& at, const Line& line,
                                                     int threads);

}  // namespace peristat
