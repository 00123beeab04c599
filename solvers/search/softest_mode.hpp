#pragma once

#include <vector>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Finds the eigenvector of the exact tangent K_ff whose eigenvalue is nearest to zero, by inverse
/// iteration. Near a critical point this eigenvalue is the vanishing one. If several vanish
/// together, the mode is one combination of theirs, which depends on the numbering of the points.
/// @param mode per degree of freedom, of norm 1; its first entry of half the largest size or more
///        is positive
[[nodiscard]] LinearOutcome find_softest_mode(const EquilibriumProblem& problem,
                                              LinearSolver& solver, TangentOperator& tangent,
                                              const StateView& at, std::vector<double>& mode);

}  // namespace peristat
