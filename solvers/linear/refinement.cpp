#include "solvers/linear/refinement.hpp"

#include <algorithm>
#include <vector>

#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Largest relative residual of a solve, after refinement, and largest backward error. Near a
/// critical point the solution is so large that its round-off exceeds the former: it then solves a
/// system that is as near as the latter.
constexpr double accepted_residual = 1e-6, accepted_backward_error = 1e-12;

/// Largest number of corrections by the residual: more do not help where two did not. A relative
/// residual below `fine` needs none.
constexpr int most_refinements = 2;
constexpr double fine = 1e-12;

}  // namespace

LinearOutcome solve_refined(const TangentOperator& tangent, const FreeDofs& free,
                            const FactorSolve& factor, std::span<const double> b,
                            std::span<double> x) {
  std::vector<double> full(free.equation.size()), other, residual(b.size());
  if (!tangent.multiplies_in_place()) other.resize(full.size());
  const std::span<double> product = other.empty() ? full : other;
  const auto find_residual = [&] {
    free.extend_by_zero(x, full);
    tangent.multiply(full, product);
    free.restrict_to_free(product, residual);
    for (std::size_t e = 0; e < b.size(); ++e) residual[e] = b[e] - residual[e];
  };

  std::copy(b.begin(), b.end(), x.begin());
  factor.apply(x);
  find_residual();
  const double size = norm(b);
  for (int k = 0; k < most_refinements && norm(residual) > fine * size; ++k) {
    factor.apply(residual);
    add_scaled(x, 1.0, residual);
    find_residual();
  }
  const bool is_accurate =
      norm(residual) <= accepted_residual * size ||
      norm(residual) <= accepted_backward_error * factor.largest_row_sum() * norm(x);
  return is_accurate ? LinearOutcome::solved : LinearOutcome::inaccurate;
}

}  // namespace peristat
