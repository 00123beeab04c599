#pragma once

#include "solvers/linear/linear_solver.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Returns the worst outcome of all ranks, so that all go on alike.
/// Collective.
[[nodiscard]] inline LinearOutcome worst_outcome(const Communicator& ranks, LinearOutcome outcome) {
  // The largest enumerator counts: `solved` comes first.
  return LinearOutcome(int(ranks.max(double(outcome))));
}

}  // namespace peristat
