#pragma once

#include <functional>
#include <span>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// What a factorisation of K_ff offers to a direct solve.
struct FactorSolve {
  /// v = K_ff^-1 v up to round-off, one entry per equation.
  std::function<void(std::span<double> v)> apply;
  /// Of the absolute entries of K [N/m]; asked for where the residual is large.
  std::function<double()> largest_row_sum;
};

/// Solves K_ff x = b by a factor, corrected by the residual that the operator itself leaves, twice
/// at most.
/// @return inaccurate where the residual stays above 1e-6 of b, and above what is round-off in a
///         solution of its size
[[nodiscard]] LinearOutcome solve_refined(const TangentOperator& tangent, const FreeDofs& free,
                                          const FactorSolve& factor, std::span<const double> b,
                                          std::span<double> x);

}  // namespace peristat
