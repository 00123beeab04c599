#include "solvers/search/convergence.hpp"

namespace peristat {
namespace {

/// An iteration that leaves more than this fraction of the residual has stagnated.
constexpr double stagnation = 0.5;

/// Largest relative residual that is accepted at round-off, unless the loads themselves are at
/// round-off, as in a body that is torn through.
constexpr double coarsest_round_off = 1e-6;

/// Loads below this multiple of the residual's round-off are round-off themselves: they accumulate
/// that of all points and of earlier states. Measured: 1.6.
constexpr double round_off_of_loads = 10.0;

}  // namespace

bool note_convergence(const EquilibriumProblem& problem, const TangentOperator& tangent,
                      const Trial& current, double last_residual, double relative_tolerance,
                      NewtonResult& result) {
  if (current.degenerate) return false;
  result.largest_residual = relative_tolerance * result.scale;
  if (current.residual_norm <= result.largest_residual) return true;
  if (result.iterations < 2 || current.residual_norm < stagnation * last_residual) return false;
  const double round_off =
      residual_round_off(problem.sums(), problem.free, tangent, current.displacement);
  if (current.residual_norm > coarsest_round_off * result.scale &&
      result.scale > round_off_of_loads * round_off) {
    return false;
  }
  result.is_at_round_off = current.residual_norm <= round_off;
  if (result.is_at_round_off) result.largest_residual = round_off;
  return result.is_at_round_off;
}

}  // namespace peristat
