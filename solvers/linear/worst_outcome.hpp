#pragma once

#include "solvers/linear/linear_solver.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// The worst that any rank has met, so that all go on alike.
/// @param ranks null: there is this one alone
[[nodiscard]] inline LinearOutcome worst_outcome(const Communicator* ranks, LinearOutcome outcome) {
  // They stand in the order of what may follow: solved comes first.
  return ranks ? LinearOutcome(int(ranks->max(double(outcome)))) : outcome;
}

}  // namespace peristat
