#include "solvers/newton.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/vector_verbs.hpp"

namespace peristat {
namespace {

/// Norms that a residual is measured against [N].
double residual_scale(const EquilibriumProblem& problem, std::span<const double> external_force,
                      const Trial& old_state, const Trial& after_jump) {
  double reactions = 0.0;
  for (std::size_t dof = 0; dof < external_force.size(); ++dof) {
    if (problem.free.equation[dof] != FreeDofs::none) continue;
    const double reaction = old_state.gradient[dof] - external_force[dof];
    reactions += reaction * reaction;
  }
  return std::max({norm(external_force), std::sqrt(reactions), after_jump.residual_norm});
}

/// Right-hand side of an iteration: f_ext - dE/dx - K jump on the free degrees of freedom.
void out_of_balance(const EquilibriumProblem& problem, std::span<const double> external_force,
                    std::span<const double> gradient, std::span<const double> force_of_jump,
                    std::span<double> result) {
  for (std::size_t e = 0; e < result.size(); ++e) {
    const Index dof = problem.free.dof[e];
    result[e] = external_force[dof] - gradient[dof];
    if (!force_of_jump.empty()) result[e] -= force_of_jump[dof];
  }
}

Outcome outcome_of(LinearOutcome linear) {
  switch (linear) {
    case LinearOutcome::solved:
      return Outcome::converged;
    case LinearOutcome::not_positive_definite:
      return Outcome::not_positive_definite;
    case LinearOutcome::singular:
      return Outcome::singular_tangent;
    case LinearOutcome::out_of_memory:
      return Outcome::out_of_memory;
    case LinearOutcome::inaccurate:
      return Outcome::linear_solver_inaccurate;
  }
  return Outcome::singular_tangent;
}

}  // namespace

NewtonResult newton(const EquilibriumProblem& problem, LinearSolver& solver, Tangent& tangent,
                    const State& from, double load_factor, const NewtonOptions& options,
                    const IterationObserver& observer) {
  const std::size_t dofs = from.displacement.size();
  NewtonResult result;
  result.external_force.resize(dofs);
  problem.conditions.external_force(load_factor, result.external_force);
  const std::vector<double>& external_force = result.external_force;

  Trial& current = result.state;
  current.displacement = from.displacement;
  current.gradient.resize(dofs);
  evaluate(problem, external_force, current);
  const Trial old_state = current;

  problem.conditions.prescribe(load_factor, current.displacement);
  std::vector<double> jump = current.displacement;
  add_scaled(jump, -1.0, from.displacement);
  evaluate(problem, external_force, current);
  const double scale = residual_scale(problem, external_force, old_state, current);

  const auto record = [&](int iteration, double step_length, int linear_iterations) {
    IterationRecord row;
    row.iteration = iteration;
    row.residual = current.residual_norm;
    row.relative_residual = scale > 0.0 ? current.residual_norm / scale : 0.0;
    row.energy = current.total_energy;
    row.step_length = step_length;
    row.linear_iterations = linear_iterations;
    return observer && observer(row);
  };
  const auto converged = [&] {
    return !current.degenerate && current.residual_norm <= options.relative_tolerance * scale;
  };
  // A state right after the jump may be degenerate (a support driven onto a neighbour); the
  // predictor is what moves the neighbours away, so only its result is judged.
  if (!current.degenerate && record(0, 0.0, 0)) {
    result.outcome = Outcome::interrupted;
    return result;
  }
  if (converged()) return result;

  Trial next = current;
  std::vector<double> right_hand_side(problem.free.count()), solution(problem.free.count());
  std::vector<double> direction(dofs), force_of_jump;
  for (int iteration = 1; iteration <= options.max_iterations; ++iteration) {
    const Trial& linearised_at = iteration == 1 ? old_state : current;
    problem.assembler.tangent(linearised_at.displacement, tangent);
    force_of_jump.clear();
    if (iteration == 1) {
      force_of_jump.resize(dofs);
      problem.assembler.product(old_state.displacement, jump, force_of_jump);
    }
    out_of_balance(problem, external_force, linearised_at.gradient, force_of_jump, right_hand_side);

    // The first tangent of a load step is always factorised: its pivots tell whether the state that
    // the step starts from is stable.
    LinearOutcome linear =
        solver.factorize(tangent, iteration == 1 ? FactorUse::factorize_now : FactorUse::may_reuse);
    if (linear == LinearOutcome::solved) linear = solver.solve(right_hand_side, solution);
    result.inertia = solver.inertia();
    result.outcome = outcome_of(linear);
    if (result.outcome != Outcome::converged) return result;

    problem.free.extend_by_zero(solution, direction);
    LineSearchResult search =
        line_search(problem, external_force, current, direction, options.line_search, next);
    if (iteration == 1 && search.outcome != Outcome::converged) {
      // The jump can leave a state in which the energy tells nothing (collapsed or overstretched
      // bonds beside the supports): the predictor is then taken in full, and the next iteration
      // judges it.
      next.displacement = current.displacement;
      add_scaled(next.displacement, 1.0, direction);
      evaluate(problem, external_force, next);
      search = {next.degenerate ? Outcome::degenerate : Outcome::converged, 1.0};
    }
    result.outcome = search.outcome;
    if (result.outcome != Outcome::converged) return result;
    std::swap(current, next);
    result.iterations = iteration;
    if (record(iteration, search.step_length, solver.last_iterations())) {
      result.outcome = Outcome::interrupted;
      return result;
    }
    if (converged()) return result;
  }
  result.outcome = Outcome::iteration_limit;
  return result;
}

}  // namespace peristat
