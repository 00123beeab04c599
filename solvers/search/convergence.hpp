#pragma once

#include "solvers/search/newton.hpp"

namespace peristat {

/// Whether a search has come to an equilibrium: the residual is within the tolerance or, where an
/// iteration hardly lowers it any more, within what round-off leaves. Tells in the result which,
/// and what counted.
/// @param tangent       near the state
/// @param last_residual norm before the last iteration [N]
[[nodiscard]] bool note_convergence(const EquilibriumProblem& problem,
                                    const TangentOperator& tangent, const Trial& current,
                                    double last_residual, double relative_tolerance,
                                    NewtonResult& result);

}  // namespace peristat
