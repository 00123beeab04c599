#pragma once

#include <functional>
#include <span>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// Factorisation of K_ff, as a direct solve uses it.
struct FactorSolve {
  /// v = K_ff^-1 v up to round-off, one entry per equation.
  std::function<void(std::span<double> v)> apply;
  /// Largest row sum of the absolute entries of K [N/m]; called only if the residual is large.
  std::function<double()> largest_row_sum;
};

/// Solves K_ff x = b by a factor, with at most two corrections by the residual of the operator
/// itself.
/// @return inaccurate if the residual stays above 1e-6 of b, and above the round-off of a solution
///         of its size
[[nodiscard]] LinearOutcome solve_refined(const TangentOperator& tangent, const FreeDofs& free,
                                          const FactorSolve& factor, std::span<const double> b,
                                          std::span<double> x);

}  // namespace peristat
