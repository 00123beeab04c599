#pragma once

#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "assembly/terms/model.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Largest stretch l/L - 1 of the unbroken bonds of each point; 0 without such a bond.
/// @return the largest of all unbroken bonds; minus infinity without one
double point_stretches(const Points& points, const Model& model, const StateView& at,
                       std::span<double> stretches, int threads);

/// Largest equivalent stretch of the unbroken bonds of each point, of images that of their source;
/// 0 without one that is driven.
[[nodiscard]] std::vector<double> largest_driving(const Points& points, const Bonds& bonds,
                                                  std::span<const BondDrive> drives,
                                                  std::span<const char> broken);

}  // namespace peristat
