#pragma once

#include "solvers/linear/linear_solver.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// Returns the worst outcome of all ranks, so that all go on alike.
/// @param ranks null: the body is not partitioned
[[nodiscard]] inline LinearOutcome worst_outcome(const Communicator* ranks, LinearOutcome outcome) {
  // The largest enumerator counts: `solved` comes first.
  return ranks ? LinearOutcome(int(ranks->max(double(outcome)))) : outcome;
}

}  // namespace peristat
