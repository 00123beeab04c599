#pragma once

#include <span>

#include "solvers/problem/equilibrium.hpp"

namespace peristat {

struct LineSearchOptions {
  double sufficient_decrease = 1e-4;  ///< required fraction of the predicted decrease (Armijo)
  double shrink = 0.5;                ///< factor on the step length after a rejected trial
  int max_trials = 25;
};

struct LineSearchResult {
  Outcome outcome = Outcome::converged;
  double step_length = 0.0;
  int rejected = 0;    ///< trials whose energy was too high
  int degenerate = 0;  ///< trials in which a measure had no gradient, or a value was not finite
};

/// Finds the largest step length l, l shrink, l shrink^2, … with l = allowed_share (1 without
/// contacts) along `direction` (zero on prescribed degrees of freedom) that lowers the
/// total energy sufficiently; `trial` becomes the accepted state.
///
/// Residuals may rise on the way to equilibrium (in bending they always do at first), the energy
/// may not. Near convergence differences of the energy are below round-off. A trial whose energy is
/// unchanged within round-off is therefore accepted if the slope along the direction has become
/// smaller in size.
[[nodiscard]] LineSearchResult line_search(const EquilibriumProblem& problem,
                                           std::span<const double> external_force,
                                           const Trial& from, std::span<const double> direction,
                                           const LineSearchOptions& options, Trial& trial,
                                           Damage damage = Damage::grows);

}  // namespace peristat
