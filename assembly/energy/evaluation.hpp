#pragma once

#include <algorithm>

#include "src/core/types.hpp"

namespace peristat {

/// Bonds that are stretched beyond their history.
struct DamageGrowth {
  Index degrading = 0;  ///< bonds that lose integrity
  Index breaking = 0;   ///< of these, bonds that lose the last of it
  /// Largest ratio of a bond's stretch to that beyond which it is damaged: damage grows above 1.
  /// Only of a pass that does not commit.
  double utilisation = 0.0;
};

/// What a pass over the interactions finds besides what it adds up.
struct Evaluation {
  double energy = 0.0;      ///< [J]
  bool degenerate = false;  ///< a measure without gradient at zero has reached it, or a value is
                            ///< not finite: reject the state
  DamageGrowth growth{};    ///< only of a pass that commits
  /// Only of a pass that commits: energy that triangles and tetrahedra lose with the integrity of
  /// their bonds [J].
  double released = 0.0;
  /// Only of a pass that commits: forces are no longer those of the bonds' loading, since others
  /// have lost their stiffness with them.
  bool moves_equilibrium = false;
  /// What the energy is a difference of, times the unit round-off [J]; 0: no more than itself.
  double round_off = 0.0;

  /// Adds what another term has found.
  void operator+=(const Evaluation& other) {
    energy += other.energy;
    round_off += other.round_off;
    degenerate |= other.degenerate;
    growth.degrading += other.growth.degrading;
    growth.breaking += other.growth.breaking;
    growth.utilisation = std::max(growth.utilisation, other.growth.utilisation);
    released += other.released;
    moves_equilibrium |= other.moves_equilibrium;
  }
};

}  // namespace peristat
