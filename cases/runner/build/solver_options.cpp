#include "cases/runner/build/solver_options.hpp"

#include "assembly/operators/matrix_free_tangent.hpp"
#include "assembly/operators/tangent.hpp"
#include "cases/runner/process/available_memory.hpp"

namespace peristat {

LinearSolverOptions linear_solver_options(const Case& from) {
  LinearSolverOptions options;
  options.method = from.solver.linear;
  options.preconditioner = from.solver.preconditioner;
  return options;
}

LinearSystems choose_linear_systems(const Case& from, const MemoryEstimate& estimate,
                                    SolverLadder::Reporter tell) {
  const LinearSolverOptions options = linear_solver_options(from);
  LinearProblem problem;
  problem.bonds = estimate.size.bonds;
  problem.factor_flops = estimate.factor_flops;
  problem.factor_bytes = estimate.direct_bytes();
  problem.available_bytes = available_memory() - estimate.body_bytes - estimate.tangent_bytes;
  // Elsewhere damage grows in relaxation, which finds stable states alone.
  problem.may_soften =
      from.material.damage.law != DamageLaw::none && from.solver.mode == Mode::newton;
  problem.is_stored = from.solver.tangent != TangentStorage::matrix_free;
  LinearSystems systems;
  systems.chosen = make_linear_solver(options, problem, tell);
  // Products computed anew take less memory; in 3D they are faster than stored ones, in 2D a sixth
  // slower.
  if (from.solver.tangent == TangentStorage::automatic && !systems.chosen.is_direct &&
      from.material.model == MaterialModel::bond && can_be_matrix_free(options)) {
    problem.is_stored = false;
    systems.chosen = make_linear_solver(options, problem, std::move(tell));
  }
  systems.is_stored = problem.is_stored;
  systems.bytes = estimate.bytes(systems.chosen.is_direct, systems.is_stored, options);
  return systems;
}

std::unique_ptr<TangentOperator> LinearSystems::make_tangent(Assembler& assembler) const {
  if (!is_stored) return std::make_unique<MatrixFreeTangent>(assembler);
  return std::make_unique<Tangent>(assembler);
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
  options.relaxation_steps = from.relaxation.steps;
  options.relaxation = from.relaxation.options;
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
