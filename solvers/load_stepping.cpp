#include "solvers/load_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/vector_verbs.hpp"

namespace peristat {
namespace {

/// A remainder of the load factor below this is round-off of the sum of steps.
constexpr double end_tolerance = 1e-9;

/// Forces that do work on the body: loads, and on prescribed degrees of freedom what holds them,
/// which is dE/dx there.
std::vector<double> working_force(const FreeDofs& free, const std::vector<double>& external_force,
                                  const std::vector<double>& gradient) {
  std::vector<double> force = external_force;
  for (std::size_t dof = 0; dof < force.size(); ++dof) {
    if (free.equation[dof] == FreeDofs::none) force[dof] = gradient[dof];
  }
  return force;
}

double trapezoidal_work(const std::vector<double>& force0, const std::vector<double>& force1,
                        const std::vector<double>& u0, const std::vector<double>& u1) {
  double work = 0.0;
  for (std::size_t k = 0; k < u0.size(); ++k)
    work += 0.5 * (force0[k] + force1[k]) * (u1[k] - u0[k]);
  return work;
}

/// Whether a smaller step can help.
bool worth_cutting(const NewtonResult& attempt) {
  const Outcome outcome = attempt.outcome;
  return !attempt.unstable_start && outcome != Outcome::interrupted &&
         outcome != Outcome::out_of_memory && outcome != Outcome::singular_tangent;
}

}  // namespace

LoadSteppingResult follow_loading(const EquilibriumProblem& problem, LinearSolver& solver,
                                  Tangent& tangent, const LoadSteppingOptions& options,
                                  const NewtonOptions& newton_options,
                                  const LoadSteppingObserver& observer) {
  const std::size_t dofs = problem.free.equation.size();
  LoadSteppingResult result;
  result.state.displacement.assign(dofs, 0.0);

  std::vector<double> gradient(dofs), external_force(dofs);
  problem.conditions.external_force(0.0, external_force);
  const Stored reference = problem.assembler.gradient(result.state.displacement, gradient);
  std::vector<double> force = working_force(problem.free, external_force, gradient);
  double external_work = reference.energy;  // of a body that is not free of stress in the reference

  const double nominal = 1.0 / options.steps;
  const double largest = options.largest_step > 0.0 ? options.largest_step : nominal;
  double increment = std::min(nominal, largest);

  while (1.0 - result.state.load_factor > end_tolerance) {
    const double rest = 1.0 - result.state.load_factor;
    const double attempted = rest - increment > end_tolerance ? increment : rest;
    const double target = attempted == rest ? 1.0 : result.state.load_factor + attempted;
    const int step = result.steps + 1;
    NewtonResult attempt = newton(problem, solver, tangent, result.state, target, newton_options,
                                  [&](IterationRecord row) {
                                    row.step = step;
                                    if (observer.iteration) observer.iteration(row);
                                    return observer.interrupted && observer.interrupted();
                                  });
    DecisionRecord decision;
    decision.step = step;
    decision.load_factor = target;
    decision.increment = attempted;
    decision.outcome = name(attempt.outcome);
    decision.next_increment = increment;

    if (attempt.outcome == Outcome::converged) {
      const bool easy = attempt.iterations <= options.easy_iterations;
      decision.action = "accept";
      decision.reason = std::to_string(attempt.iterations) + " iterations";
      if (options.adaptive && easy && increment < largest) {
        increment = std::min(options.growth * increment, largest);
        decision.action = "accept and grow";
        decision.next_increment = increment;
      }
      const std::vector<double> next_force =
          working_force(problem.free, attempt.external_force, attempt.state.gradient);
      external_work += trapezoidal_work(force, next_force, result.state.displacement,
                                        attempt.state.displacement);
      force = next_force;
      result.state.displacement = attempt.state.displacement;
      result.state.load_factor = target;
      result.steps = step;

      StepRecord record;
      record.step = step;
      record.load_factor = target;
      record.mode = "newton";
      record.newton_iterations = attempt.iterations;
      record.stored_energy = attempt.state.stored_energy;
      record.external_work = external_work;
      record.balance_error = external_work - record.stored_energy;
      record.reactions =
          problem.conditions.reactions(attempt.state.gradient, attempt.external_force);
      if (observer.decision) observer.decision(decision);
      if (observer.accepted) observer.accepted(record, attempt);
      result.last_attempt = std::move(attempt);
      continue;
    }

    const double next = attempted * options.cut;
    const bool cut = options.adaptive && worth_cutting(attempt) && next >= options.smallest_step;
    decision.reason = explanation(attempt.outcome);
    if (attempt.inertia && attempt.inertia->negative > 0) {
      decision.reason += " (" + std::to_string(attempt.inertia->negative) + " negative pivots)";
    }
    decision.action = cut ? "cut" : "stop";
    decision.next_increment = cut ? next : 0.0;
    if (observer.decision) observer.decision(decision);
    if (!cut) {
      result.outcome = attempt.outcome;
      result.last_attempt = std::move(attempt);
      return result;
    }
    increment = next;
  }
  return result;
}

}  // namespace peristat
