#include "solvers/drivers/relaxed_step.hpp"

#include <algorithm>
#include <utility>

#include "solvers/search/flow.hpp"
#include "src/core/stopwatch.hpp"

namespace peristat {
namespace {

/// Newton iterations that may finish a relaxed step: quadratic convergence needs no more.
constexpr int most_finishing_iterations = 8;

/// Options that accept only a stable equilibrium close by; anything else is left to relaxation.
NewtonOptions finishing_options(NewtonOptions options, bool has_factor) {
  options.projection = Projection::never;
  options.factorizes_first = !has_factor;
  options.counts_pivots = false;
  options.max_iterations = std::min(options.max_iterations, most_finishing_iterations);
  return options;
}

/// Does Newton's last iterations at the fixed load.
/// @return false if relaxation has to go on
bool finish(Path& path, RelaxedStep& step, NewtonOptions options) {
  options.scale = step.scale;
  const State near = state_of(step.attempt);
  Attempt finished = path.search(near, load_point(near), options);
  step.has_factor |= finished.iterations > 0;
  if (!finished.has_converged() && worth_relaxing(finished)) return false;
  step.found.record.newton_iterations += finished.iterations;
  if (finished.has_converged()) {
    step.found.record.settled = false;
    step.found.energies.relaxed->drained +=
        step.attempt.state.total_energy - finished.state.total_energy;
    const Sums sums = path.problem().sums();
    step.found.energies.relaxed->work +=
        sums.dot(finished.external_force, finished.state.displacement) -
        sums.dot(finished.external_force, near.displacement);
  }
  step.attempt = std::move(finished);
  return true;
}

}  // namespace

RelaxedStep::RelaxedStep(const State& accepted) {
  found.record.mode = Mode::relaxation.name;
  found.energies.relaxed.emplace();
  attempt.state.displacement = accepted.displacement;
  attempt.state.history = accepted.history;
  attempt.state.environment = accepted.environment;
  attempt.at = load_point(accepted);
}

void relax_towards(Path& path, RelaxedStep& step, const LoadPoint& target,
                   RelaxationOptions options) {
  const State from = state_of(step.attempt);
  if (load_point(from) == target && options.holds) options.ramp = 1;
  options.scale = step.scale;
  const Stopwatch watch(path.state().relaxation_seconds);
  const auto tell = [&](const IterationRecord& row) { return path.iterated(row); };
  const SolvedBody& body = path.body();
  RelaxationResult relaxed =
      options.method == RelaxationMethod::flow
          ? flow(path.problem(), body.solver, body.tangent, from, target, options, tell)
          : relax(path.problem(), body.tangent, from, target, options, path.state().relaxed.motion,
                  tell);
  step.found.record.relaxation_iterations += relaxed.iterations;
  step.found.record.settled = relaxed.largest_residual < 0.0;
  step.found.energies.relaxed->work += relaxed.external_work;
  step.found.energies.relaxed->drained += relaxed.drained_energy;
  step.found.growth += relaxed.growth;
  step.found.energies.released += relaxed.released_energy;
  step.found.energies.struts += relaxed.growth.strut_energy;
  step.scale = relaxed.scale;
  step.attempt = to_attempt(std::move(relaxed), target);
}

void relax_and_finish(Path& path, RelaxedStep& step, const LoadPoint& target) {
  const NewtonOptions& newton_options = path.setting().newton_options;
  RelaxationOptions options = path.options().relaxation;
  const double last = options.relative_tolerance;
  for (double tolerance = path.options().newton_takes_over_at;; tolerance *= 1e-2) {
    options.relative_tolerance = std::max(tolerance, last);
    relax_towards(path, step, target, options);
    if (step.attempt.outcome == Outcome::iteration_limit) {
      // A motion of little stiffness, as of a part that hangs on its last bonds, hardly relaxes; a
      // search with projected tangents finds its equilibrium.
      finish(path, step, newton_options);
      return;
    }
    const bool goes_on = step.attempt.has_converged() && tolerance > last;
    if (!goes_on || finish(path, step, finishing_options(newton_options, step.has_factor))) return;
  }
}

}  // namespace peristat
