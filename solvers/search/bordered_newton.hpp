#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solvers/search/condition_rates.hpp"
#include "solvers/search/newton.hpp"

namespace peristat {

/// Linear equation that makes a load an unknown:
///
///   weights . u + unknown_weight * unknown = value
struct BorderEquation {
  std::span<const double> weights;  ///< per degree of freedom; empty: zero
  double unknown_weight = 0.0;
  double value = 0.0;
};

/// Derivative d(weights . u + unknown_weight * unknown) / d unknown for a rate du / d unknown;
/// nothing if it is no more than round-off.
[[nodiscard]] std::optional<double> answer_of(const BorderEquation& border,
                                              std::span<const double> rate);

/// Predicted state from which a search begins.
struct Prediction {
  std::vector<double> displacement;
  double unknown = 0.0;
  /// Displacement at which contacts are closed that the search is to close; empty: the predicted
  /// one.
  std::vector<double> foreseen{};
};

/// Definition of a bordered search.
struct BorderedStep {
  LoadPath loads;
  BorderEquation border;
  double unknown = 0.0;  ///< in the old state
  /// Without a prediction the search begins by linearising about the old state.
  std::optional<Prediction> prediction{};
};

struct BorderedResult {
  NewtonResult newton;
  double unknown = 0.0;
};

/// Newton-Raphson for equilibrium together with a linear equation for the load:
///
///   f_ext(l) - dE/dx_f(u) = 0,   weights . u + w l = value,   u_p = u_p(l).
///
/// Each iteration solves K_ff a = f_ext - dE/dx_f - K_fp jump_p and K_ff b = df_ext/dl - K_fp
/// du_p/dl by one factor, and goes to u_f + a + dl b with the dl that fulfils the border (Batoz and
/// Dhatt, Int. J. Numer. Methods Eng. 14, 1979). Steps are full, except where contacts would pass
/// their largest depth: between two limit points the energy is no merit function. The tangent may
/// have negative pivots, which the solver must accept.
///
/// With contacts the first iteration is that of predict_with_contacts about the old state, also
/// instead of a prediction that closes or opens some. A state in which a contact has been passed
/// through is degenerate.
///
/// Rates of supports and loads are central differences over 2^-13, to about 1e-9; for conditions
/// that are linear in the load they are exact to round-off.
///
/// The residual is measured against the largest of loads and reactions in the old and the present
/// state.
/// @return outcome no_answer if the left side of the border does not depend on the unknown
[[nodiscard]] BorderedResult bordered_newton(const EquilibriumProblem& problem,
                                             LinearSolver& solver, TangentOperator& tangent,
                                             const State& from, const BorderedStep& step,
                                             const NewtonOptions& options,
                                             const IterationObserver& observer);

/// Finds the rate du / d unknown of the equilibrium, by the exact tangent of a state; the solver
/// then has the signs of its pivots.
[[nodiscard]] LinearOutcome find_rate(const EquilibriumProblem& problem, LinearSolver& solver,
                                      TangentOperator& tangent, const StateView& at,
                                      const LoadPath& loads, double unknown,
                                      std::vector<double>& rate);

}  // namespace peristat
