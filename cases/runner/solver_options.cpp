#include "cases/runner/solver_options.hpp"

namespace peristat {

LinearSolverOptions linear_solver_options(const Case& from) {
  LinearSolverOptions options;
  options.method = from.solver.linear;
  options.preconditioner = from.solver.preconditioner;
  return options;
}

LinearProblem linear_problem(const Case& from, const MemoryEstimate& estimate) {
  LinearProblem problem;
  problem.bonds = estimate.bonds;
  problem.factor_flops = estimate.factor_flops;
  problem.factor_bytes = estimate.direct_bytes();
  problem.available_bytes = available_memory() - estimate.body_bytes;
  problem.may_soften = from.material.damage.law != DamageLaw::none;
  return problem;
}

LoadSteppingOptions load_stepping_options(const Case& from) {
  LoadSteppingOptions options;
  options.mode = from.solver.mode;
  options.steps = from.loading.steps;
  options.adaptive = from.loading.adaptive;
  options.smallest_step = from.loading.smallest_step;
  options.largest_step = from.loading.largest_step;
  options.max_broken_bonds = from.loading.max_broken_bonds;
  options.fragments = from.solver.fragments;
  options.has_cracks = !from.cracks.empty();
  options.relaxation_steps = from.relaxation.steps;
  options.relaxation = from.relaxation.options;
  return options;
}

NewtonOptions newton_options(const Case& from) {
  NewtonOptions options;
  options.relative_tolerance = from.solver.relative_tolerance;
  options.max_iterations = from.solver.max_iterations;
  options.predictor = from.solver.predictor;
  options.projection = from.solver.projection;
  return options;
}

}  // namespace peristat
