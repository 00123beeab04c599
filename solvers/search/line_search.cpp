#include "solvers/search/line_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Derivative of the total energy along the direction [J].
double slope_along(const Sums& sums, std::span<const double> direction, const Trial& trial,
                   std::span<const double> external_force) {
  return sums.dot(direction, trial.gradient) - sums.dot(direction, external_force);
}

/// Work of follower forces, which need not have a potential, by the trapezoidal rule: exact in a
/// plane, elsewhere with an error of the cube of the step [J].
double follower_work(const EquilibriumProblem& problem, const Trial& from, const Trial& to) {
  if (!problem.conditions.has_pressures()) return 0.0;
  double work = 0.0;
  for (std::size_t k = 0; k < to.follower_force.size(); ++k) {
    work += 0.5 * (from.follower_force[k] + to.follower_force[k]) *
            (to.displacement[k] - from.displacement[k]);
  }
  return problem.sums().of_all(work);
}

/// Takes the whole step. Where forces are linear in the displacements it leads to equilibrium.
/// Without a potential no energy could judge a shorter step, and the energy of convolutions has
/// more round-off than the last steps gain.
LineSearchResult take_whole_step(const EquilibriumProblem& problem,
                                 std::span<const double> external_force, const Trial& from,
                                 std::span<const double> direction, Trial& trial, Damage damage) {
  trial.history = from.history;
  trial.environment = from.environment;
  trial.displacement = from.displacement;
  add_scaled(trial.displacement, 1.0, direction);
  evaluate(problem, external_force, trial, damage);
  LineSearchResult result;
  result.step_length = 1.0;
  if (trial.degenerate) result.outcome = Outcome::degenerate;
  return result;
}

}  // namespace

LineSearchResult line_search(const EquilibriumProblem& problem,
                             std::span<const double> external_force, const Trial& from,
                             std::span<const double> direction, const LineSearchOptions& options,
                             Trial& trial, Damage damage) {
  const Balances balances = problem.assembler.model().balances();
  if (!balances.potential || balances.linear) {
    return take_whole_step(problem, external_force, from, direction, trial, damage);
  }
  const Sums sums = problem.sums();
  const double slope = slope_along(sums, direction, from, external_force);
  LineSearchResult result;
  if (!std::isfinite(slope)) result.outcome = Outcome::degenerate;
  if (slope > 0.0) result.outcome = Outcome::no_descent;
  if (result.outcome != Outcome::converged) return result;

  const double work = sums.dot(external_force, from.displacement);
  // Errors of a sum grow as those of a random walk.
  const double of_sums = std::sqrt(sums.of_all(double(problem.free.dof.size())));
  const double round_off = std::max(64.0, of_sums) * std::numeric_limits<double>::epsilon() *
                               std::max(std::abs(from.stored_energy), std::abs(work)) +
                           from.energy_round_off;
  trial.history = from.history;
  trial.environment = from.environment;
  double length = allowed_share(problem, from.at(damage), direction);
  for (int count = 0; count < options.max_trials; ++count, length *= options.shrink) {
    trial.displacement = from.displacement;
    add_scaled(trial.displacement, length, direction);
    evaluate(problem, external_force, trial, damage);
    if (trial.degenerate) {
      ++result.degenerate;
      continue;
    }
    result.step_length = length;
    const double change =
        trial.total_energy - from.total_energy - follower_work(problem, from, trial);
    if (change <= options.sufficient_decrease * length * slope) return result;
    const bool flatter =
        std::abs(slope_along(sums, direction, trial, external_force)) <= std::abs(slope);
    if (std::abs(change) <= round_off && flatter) return result;
    ++result.rejected;
  }
  result.outcome = trial.degenerate ? Outcome::degenerate : Outcome::line_search_failed;
  result.step_length = 0.0;
  return result;
}

}  // namespace peristat
