#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "solvers/equilibrium.hpp"
#include "solvers/line_search.hpp"
#include "solvers/linear/linear_solver.hpp"
#include "src/results/history.hpp"

namespace peristat {

struct NewtonOptions {
  double relative_tolerance = 1e-10;
  int max_iterations = 25;
  LineSearchOptions line_search;
};

struct NewtonResult {
  Outcome outcome = Outcome::converged;
  int iterations = 0;
  std::optional<Inertia> inertia;  ///< of the last factorised tangent, if known
  Trial state;                     ///< last state reached; equilibrium only if converged
  std::vector<double> external_force;
};

/// Told of every iteration as it ends; returns true to interrupt.
using IterationObserver = std::function<bool(const IterationRecord&)>;

/// Newton-Raphson from an equilibrium state to the equilibrium at `load_factor` ([ADAPT] eqs.
/// 5-11).
///
/// Iteration 0 is the state right after the jump: prescribed displacements and loads have their new
/// values, free points have not moved. The first iteration is the consistent predictor, with the
/// tangent K of the old state,
///   K_ff du_f = f_ext - dE/dx_f(u) - K_fp du_p,
/// so that it already spreads the jump du_p of the prescribed displacements over the body; all
/// later ones are K_ff du_f = f_ext - dE/dx_f(u). Each is followed by an energy line search.
///
/// The relative residual is ||f_ext - dE/dx|| over free degrees of freedom, divided by the largest
/// of
/// ||f_ext||, the reactions' norm in the old state, and the residual of iteration 0.
[[nodiscard]] NewtonResult newton(const EquilibriumProblem& problem, LinearSolver& solver,
                                  Tangent& tangent, const State& from, double load_factor,
                                  const NewtonOptions& options, const IterationObserver& observer);

}  // namespace peristat
