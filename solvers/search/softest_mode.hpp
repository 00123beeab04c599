#pragma once

#include <vector>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Eigenvector of the exact tangent K_ff whose eigenvalue is nearest to zero, by inverse iteration.
/// Of the eigenvalues near a critical point it is the vanishing one; of several that vanish
/// together it is one combination, which the numbering of the points decides.
/// @param mode per degree of freedom, of norm 1; its first entry of half the largest size or more
///        is positive
[[nodiscard]] LinearOutcome find_softest_mode(const EquilibriumProblem& problem,
                                              LinearSolver& solver, TangentOperator& tangent,
                                              const StateView& at, std::vector<double>& mode);

}  // namespace peristat
