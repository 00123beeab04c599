#pragma once

#include "solvers/search/newton.hpp"

namespace peristat {

/// True if a search has found equilibrium: the residual is within the tolerance or, if an iteration
/// hardly lowers it any more, within its round-off. Stores in the result which of them applies, and
/// the largest residual that counts.
/// @param tangent near the state
/// @param last_residual norm before the last iteration [N]
[[nodiscard]] bool note_convergence(const EquilibriumProblem& problem,
                                    const TangentOperator& tangent, const Trial& current,
                                    double last_residual, double relative_tolerance,
                                    NewtonResult& result);

}  // namespace peristat
