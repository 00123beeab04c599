#include "cases/runner/setup/solver_options.hpp"

namespace peristat {

StudyOptions study_options(const Case& from, int threads) {
  StudyOptions options;
  options.loading = load_stepping_options(from);
  options.newton = newton_options(from);
  options.linear.method = from.solver.linear;
  options.linear.preconditioner = from.solver.preconditioner;
  options.tangent = from.solver.tangent;
  options.precision = from.solver.precision;
  options.threads = threads;
  return options;
}

LoadSteppingOptions load_stepping_options(const Case& from) {
  LoadSteppingOptions options;
  options.mode = from.solver.mode;
  options.steps = from.loading.steps_to_entry();
  options.adaptive = from.loading.adaptive;
  options.smallest_step = from.loading.smallest_step;
  options.largest_step = from.loading.largest_step;
  options.max_broken_bonds = from.loading.max_broken_bonds;
  options.stop_below = from.loading.stop_below;
  options.arc_length = from.solver.arc_length;
  options.events = from.loading.events;
  options.fatigue = from.fatigue;
  options.fragments = from.solver.fragments;
  options.relaxation_steps = from.relaxation.steps;
  options.relaxation = from.relaxation.options;
  options.peak_tolerance = from.relaxation.peak_tolerance;
  const DynamicsSpecification& dynamics = from.dynamics;
  const int rows = dynamics.history_every > 0 ? dynamics.history_every : from.output.every;
  options.dynamics = {dynamics.time_step, dynamics.step_share,      rows,
                      dynamics.scheme,    dynamics.spectral_radius, dynamics.start};
  return options;
}

NewtonOptions newton_options(const Case& from) {
  NewtonOptions options;
  options.relative_tolerance = from.solver.relative_tolerance;
  options.max_iterations = from.solver.max_iterations;
  options.linear_tolerance = from.solver.linear_tolerance;
  options.predictor = from.solver.predictor;
  options.projection = from.solver.projection;
  return options;
}

}  // namespace peristat
