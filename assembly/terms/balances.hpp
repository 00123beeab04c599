#pragma once

namespace peristat {

/// What the forces and energies of interactions fulfil in every state. They owe the sums if their
/// energy doesn't change when all of their points move or turn together, and a positive energy if
/// no constant is negative.
struct Balances {
  bool force_sum = true;        ///< internal forces add up to zero
  bool moment_sum = true;       ///< so do their moments about any point, in the present positions
  bool positive_energy = true;  ///< no stored energy is below that of the reference
  bool potential = true;        ///< forces are minus the derivative of the energy
  bool linear = false;  ///< forces are linear in the displacements, while nothing is damaged

  /// What a sum of terms owes: what each of them does.
  void restrict_to(const Balances& other) {
    force_sum = force_sum && other.force_sum;
    moment_sum = moment_sum && other.moment_sum;
    positive_energy = positive_energy && other.positive_energy;
    potential = potential && other.potential;
    linear = linear && other.linear;
  }
};

}  // namespace peristat
