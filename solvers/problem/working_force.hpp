#pragma once

#include <span>
#include <vector>

#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Forces that do work on the body: loads, and on prescribed degrees of freedom the reactions,
/// which are dE/dx there. Pins of fragments do no work: they don't move, and nothing follows when
/// they are removed. Constraints do none either: on dependent degrees of freedom only loads do
/// work.
[[nodiscard]] std::vector<double> working_force(const Conditions& conditions, const Trial& state,
                                                std::span<const double> external_force);

/// Work of forces on the straight path between two states [J], summed over the ranks.
[[nodiscard]] double trapezoidal_work(const Sums& sums, std::span<const double> force0,
                                      std::span<const double> force1, std::span<const double> u0,
                                      std::span<const double> u1);

}  // namespace peristat
