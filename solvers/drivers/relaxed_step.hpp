#pragma once

#include "solvers/drivers/found_step.hpp"

namespace peristat {

/// A relaxed step in progress: where it is, and its part of the ledger.
struct RelaxedStep {
  /// Begins at the last accepted state.
  explicit RelaxedStep(const State& accepted);

  Attempt attempt;
  FoundStep found;
  double scale = 0.0;       ///< norm that the residual is measured against [N]
  bool has_factor = false;  ///< a tangent of this step is factorised
};

/// Relaxes to a load point, by dynamic relaxation or by the flow.
void relax_towards(Path& path, RelaxedStep& step, const LoadPoint& target,
                   RelaxationOptions options);

/// The same until Newton's method is able to finish.
void relax_and_finish(Path& path, RelaxedStep& step, const LoadPoint& target);

}  // namespace peristat
