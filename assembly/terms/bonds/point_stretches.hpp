#pragma once

#include <span>

#include "assembly/energy/state.hpp"
#include "assembly/terms/model.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Largest stretch l/L - 1 of the unbroken bonds of each point; 0 without such a bond.
/// @return the largest of all unbroken bonds; minus infinity without one
double point_stretches(const Points& points, const Model& model, const StateView& at,
                       std::span<double> stretches);

}  // namespace peristat
