#pragma once

namespace peristat {

/// Conservation properties of the forces and energies of interactions, in every state. The sums are
/// zero if the energy doesn't change when all points of an interaction move or turn together; the
/// energy is positive if no constant is negative.
struct Balances {
  bool force_sum = true;        ///< internal forces add up to zero
  bool moment_sum = true;       ///< so do their moments about any point, in the present positions
  bool positive_energy = true;  ///< no stored energy is below that of the reference
  bool potential = true;        ///< forces are minus the derivative of the energy
  bool linear = false;  ///< forces are linear in the displacements, while nothing is damaged

  /// Keeps the balances that another term fulfils, too, as for a sum of terms.
  void restrict_to(const Balances& other) {
    force_sum = force_sum && other.force_sum;
    moment_sum = moment_sum && other.moment_sum;
    positive_energy = positive_energy && other.positive_energy;
    potential = potential && other.potential;
    linear = linear && other.linear;
  }
};

}  // namespace peristat
