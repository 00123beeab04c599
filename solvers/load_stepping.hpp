#pragma once

#include <functional>
#include <string>

#include "solvers/newton.hpp"

namespace peristat {

struct LoadSteppingOptions {
  int steps = 1;         ///< equal steps of the load factor from 0 to 1
  bool adaptive = true;  ///< cut after a failure and grow again; otherwise a failure ends the run
  double smallest_step = 1e-6;  ///< of the load factor; a cut below it ends the run
  double largest_step = 0.0;    ///< of the load factor; 0 means 1 / steps
  double cut = 0.5;             ///< factor of the step after a failure
  double growth = 2.0;          ///< factor of the step after an easy success, up to largest_step
  int easy_iterations = 5;      ///< a step with no more iterations than this was easy
};

/// Receives what happens; all members may be empty.
struct LoadSteppingObserver {
  std::function<void(const IterationRecord&)> iteration;
  std::function<void(const DecisionRecord&)> decision;
  /// An accepted equilibrium. The record's energies and reactions are set.
  std::function<void(const StepRecord&, const NewtonResult&)> accepted;
  std::function<bool()> interrupted;
};

struct LoadSteppingResult {
  Outcome outcome = Outcome::converged;
  int steps = 0;  ///< accepted
  State state;    ///< last accepted
  NewtonResult last_attempt;
};

/// Follows the equilibrium from load factor 0 to 1 in steps; every decision is told.
///
/// External work is summed with the trapezoidal rule over each step, of the loads on the free and
/// of the reactions on the prescribed degrees of freedom; the balance error is that rule's.
[[nodiscard]] LoadSteppingResult follow_loading(const EquilibriumProblem& problem,
                                                LinearSolver& solver, Tangent& tangent,
                                                const LoadSteppingOptions& options,
                                                const NewtonOptions& newton_options,
                                                const LoadSteppingObserver& observer);

}  // namespace peristat
