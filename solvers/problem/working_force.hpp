#pragma once

#include <span>
#include <vector>

#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Forces that do work on the body: loads, and on prescribed degrees of freedom what holds them,
/// which is dE/dx there. Pins of fragments do none: they don't move, and when they are taken away
/// nothing follows them. Constraints do none either: what follows others bears its loads alone.
[[nodiscard]] std::vector<double> working_force(const Conditions& conditions, const Trial& state,
                                                std::span<const double> external_force);

/// Work of forces on the straight way between two states [J], of all ranks.
[[nodiscard]] double trapezoidal_work(const Sums& sums, std::span<const double> force0,
                                      std::span<const double> force1, std::span<const double> u0,
                                      std::span<const double> u1);

}  // namespace peristat
