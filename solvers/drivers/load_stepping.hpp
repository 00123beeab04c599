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

/// Follows the equilibrium along the loading programme in steps; every decision is told.
///
/// The steps are those of the mode's driver (solvers/drivers/).
///
/// External work is summed with the trapezoidal rule over each step, of the loads on the free and
/// of the reactions on the prescribed degrees of freedom. Relaxation sums the work over each of its
/// iterations, too: what that is more is the numerical work. The balance error is that rule's in
/// implicit steps, and what unstable ones release.
///
/// Before a step is accepted it is checked against what it owes (find_inconsistency); a step that
/// fails is cut like one that does not converge.
///
/// @param setting its stand_in is a body with the same points that is elastic and has another
/// horizon: it takes
///        the place of the body until damage begins. The body's ledger then begins with what it
///        stores in equilibrium at that load: the work that elastic steps to there would have done
/// @param from what a path with the same setting has reached; null: from rest. The rest is the
///        same as without the interruption, on one thread to the last bit
[[nodiscard]] LoadSteppingResult follow_loading(const PathSetting& setting,
                                                const PathState* from = nullptr);

}  // namespace peristat
