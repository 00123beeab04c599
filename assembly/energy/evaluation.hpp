#pragma once

#include <algorithm>

#include "src/core/types.hpp"

namespace peristat {

/// Bonds that are stretched beyond their history.
struct DamageGrowth {
  Index degrading = 0;  ///< bonds that lose integrity
  Index breaking = 0;   ///< of these, bonds that lose the last of it and break
  /// Largest ratio of a bond's stretch to the stretch that it bears: damage grows above 1. Only
  /// from a pass that does not commit.
  double utilisation = 0.0;
  /// Energy that was stored in struts, see Struts. Only from a pass that commits [J].
  double strut_energy = 0.0;

  void operator+=(const DamageGrowth& other) {
    degrading += other.degrading;
    breaking += other.breaking;
    utilisation = std::max(utilisation, other.utilisation);
    strut_energy += other.strut_energy;
  }
};

/// Result of a pass over the interactions, beside the arrays that it fills.
struct Evaluation {
  double energy = 0.0;      ///< [J]
  bool degenerate = false;  ///< a measure has reached zero, where it has no gradient, or a value is
                            ///< not finite: reject the state
  DamageGrowth growth{};    ///< only from a pass that commits
  /// Only from a pass that commits: energy that triangles and tetrahedra lose with the integrity of
  /// their bonds, or that states lose beyond what the bonds' law dissipates; and of struts what
  /// they stored less what their law counts as dissipated [J].
  double released = 0.0;
  /// Only from a pass that commits: the forces have changed, because more than the damaged bonds
  /// has lost stiffness.
  bool moves_equilibrium = false;
  /// Magnitude of the terms whose difference the energy is, times the unit round-off [J]; 0: the
  /// energy's own round-off suffices.
  double round_off = 0.0;

  /// Adds what another term has found.
  void operator+=(const Evaluation& other) {
    energy += other.energy;
    round_off += other.round_off;
    degenerate |= other.degenerate;
    growth += other.growth;
    released += other.released;
    moves_equilibrium |= other.moves_equilibrium;
  }
};

}  // namespace peristat
