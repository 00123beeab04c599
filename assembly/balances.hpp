#pragma once

#include "assembly/model.hpp"

namespace peristat {

/// What the forces and energies of a body's interactions fulfil in every state.
struct Balances {
  bool force_sum = true;        ///< internal forces add up to zero
  bool moment_sum = true;       ///< so do their moments about any point, in the present positions
  bool positive_energy = true;  ///< no stored energy is below that of the reference
};

/// Interactions owe the sums if their energy doesn't change when all of their points move or turn
/// together, as that of every measure here, and a positive energy if no constant is negative.
[[nodiscard]] Balances balances_of(const Model& model);

}  // namespace peristat
