#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "solvers/linear/linear_solver.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "solvers/problem/records.hpp"
#include "solvers/search/line_search.hpp"

namespace peristat {

/// When to project the tangent's interactions to their positive semidefinite part.
enum class Projection {
  automatic,  ///< if the exact tangent has negative pivots or its direction fails
  never,
  always,
};

/// State about which the first iteration of a load step linearises.
enum class Predictor {
  consistent,  ///< the old state; the jump of the prescribed displacements is spread over the body
  none,        ///< the state right after the jump, as every later iteration ([CPD] sec. 3.2)
};

struct NewtonOptions {
  double relative_tolerance = 1e-10;
  int max_iterations = 25;
  double linear_tolerance = 1e-3;  ///< largest relative residual of the linear systems
  Projection projection = Projection::automatic;
  Predictor predictor = Predictor::consistent;
  /// Smallest projection. A quarter of the last projection is tried first; while the tangent still
  /// has negative pivots, it is multiplied by four, up to 1.
  double least_projection = 1.0 / 16.0;
  LineSearchOptions line_search;
  Damage damage = Damage::grows;  ///< in the states that are searched
  double scale = 0.0;  ///< that the residual is measured against [N]; 0: that of this step
  /// If true, the first tangent is factorised even if an earlier factor would do, so that its
  /// pivots show whether the old state is stable.
  bool factorizes_first = true;
  bool counts_pivots = true;  ///< of the first tangent, if it is not positive definite
};

struct NewtonResult {
  Outcome outcome = Outcome::converged;
  int iterations = 0;
  std::optional<Inertia> inertia;    ///< of the last exact tangent that was factorised, if known
  double scale = 0.0;                ///< norm that the residual was measured against [N]
  bool is_at_round_off = false;      ///< converged at the level of round-off, above the tolerance
  double largest_residual = 0.0;     ///< largest residual that counted as converged [N]
  bool has_negative_pivots = false;  ///< of the last exact tangent
  bool unstable_start = false;       ///< the exact tangent of the old state has negative pivots
  Trial state;                       ///< last state reached; equilibrium only if converged
  std::vector<double> external_force;
};

/// Called at the end of every iteration; returns true to interrupt.
using IterationObserver = std::function<bool(const IterationRecord&)>;

/// Newton-Raphson from an equilibrium state to the equilibrium at a load point ([ADAPT] eqs.
/// 5-11).
///
/// Iteration 0 is the state right after the jump: prescribed displacements and loads have their new
/// values, free points have not moved. The first iteration is the consistent predictor, with the
/// tangent K of the old state,
///   K_ff du_f = f_ext - dE/dx_f(u) - K_fp du_p,
/// so that it already spreads the jump du_p of the prescribed displacements over the body; all
/// later ones are K_ff du_f = f_ext - dE/dx_f(u). Each is followed by an energy line search.
///
/// Linear systems are solved only as accurately as the present residual requires: see forcing_term.
///
/// The exact tangent always comes first, so that convergence is quadratic. If it has negative
/// pivots, or its direction does not lower the energy, every interaction's Hessian is moved towards
/// its positive semidefinite part, by as small a share as gives positive pivots: a full projection
/// always does, but is much stiffer than the body and converges slowly. The direction is then one
/// of descent, and the search continues as a minimisation of the energy. States in which a measure
/// has no gradient are rejected by the line search. From an unstable state the search may find
/// another, stable one; if it finds none, the outcome is not_positive_definite, however the search
/// ended.
///
/// The relative residual is ||f_ext - dE/dx|| over free degrees of freedom, divided by the largest
/// of ||f_ext||, the reactions' norm in the old state, and the residual of iteration 0. If an
/// iteration hardly lowers it any more and it is within its round-off, the state has converged,
/// too.
///
/// Damage is held up to the end of the first iteration: iteration 0 and the predictor have the old
/// damage.
[[nodiscard]] NewtonResult newton(const EquilibriumProblem& problem, LinearSolver& solver,
                                  TangentOperator& tangent, const State& from, const LoadPoint& at,
                                  const NewtonOptions& options, const IterationObserver& observer);

}  // namespace peristat
