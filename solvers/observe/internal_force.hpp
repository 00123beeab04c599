#pragma once

#include <span>
#include <vector>

#include "solvers/body/body.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Internal force of a state, -dE/dx of the energy of the body without its foundations and
/// obstacles; forces on dependent degrees of freedom are theirs again [N].
/// @param state evaluated under `external_force` [N]
[[nodiscard]] std::vector<double> internal_force(const Body& body, const Trial& state,
                                                 std::span<const double> external_force);

}  // namespace peristat
