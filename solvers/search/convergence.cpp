#include "solvers/search/convergence.hpp"

namespace peristat {
namespace {

/// An iteration that leaves more than this share of the residual has stagnated.
constexpr double stagnation = 0.5;

/// Largest relative residual that counts as converged because round-off leaves no less.
constexpr double coarsest_round_off = 1e-6;

}  // namespace

bool note_convergence(const FreeDofs& free, const TangentOperator& tangent, const Trial& current,
                      double last_residual, double relative_tolerance, NewtonResult& result) {
  if (current.degenerate) return false;
  result.largest_residual = relative_tolerance * result.scale;
  if (current.residual_norm <= result.largest_residual) return true;
  if (result.iterations < 2 || current.residual_norm < stagnation * last_residual ||
      current.residual_norm > coarsest_round_off * result.scale) {
    return false;
  }
  const double round_off = residual_round_off(free, tangent, current.displacement);
  result.is_at_round_off = current.residual_norm <= round_off;
  if (result.is_at_round_off) result.largest_residual = round_off;
  return result.is_at_round_off;
}

}  // namespace peristat
