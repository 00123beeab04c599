#pragma once

#include "solvers/linear/sums.hpp"
#include "solvers/motion/stable_step.hpp"

namespace peristat {

/// The same as bound_stiffness and find_stiffness for a body that is whole or distributed over
/// ranks: then the tangent is that of a part, and the calls are collective.
/// @param sharing null: the body is whole
[[nodiscard]] Stiffness bound_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                        std::span<const double> mass, int most_points,
                                        const Sharing* sharing);
[[nodiscard]] Stiffness find_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                       std::span<const double> mass, int most_points,
                                       const Sharing* sharing);

}  // namespace peristat
