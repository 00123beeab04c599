#pragma once

#include "solvers/drivers/path.hpp"

namespace peristat {

struct LoadSteppingResult {
  Outcome outcome = Outcome::converged;
  int steps = 0;                    ///< accepted
  State state;                      ///< last accepted
  double relaxation_seconds = 0.0;  ///< wall time in relaxation
  Attempt last_attempt;             ///< that failed
};

/// Follows the equilibrium along the loading programme in steps; reports every decision.
///
/// The steps are those of the mode's driver (solvers/drivers/).
///
/// External work is summed with the trapezoidal rule over each step, of the loads on the free and
/// of the reactions on the prescribed degrees of freedom. Relaxation sums the work over each of its
/// iterations, too; the excess is the numerical work. The balance error consists of the trapezoidal
/// rule's error in implicit steps, and of the energy that unstable ones release.
///
/// The balances of a step are checked before it is accepted (find_inconsistency); a step that fails
/// is cut like one that does not converge.
///
/// @param setting its stand_in is an elastic body with the same points and another horizon
///        (surrogate model), which replaces the body until damage begins. The body's ledger then
///        begins with the energy that it stores in equilibrium at that load, the work that elastic
///        steps to there would have done
/// @param from state that a path with the same setting has reached; null: from rest. The path then
///        goes on as without the interruption, on one thread to the last bit
[[nodiscard]] LoadSteppingResult follow_loading(const PathSetting& setting,
                                                const PathState* from = nullptr);

}  // namespace peristat
