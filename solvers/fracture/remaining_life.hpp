#pragma once

#include <span>
#include <vector>

#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Rate at which a bond loses its remaining life lambda, which is 1 at first ([Silling and Askari
/// 2014]):
///
///   d lambda / dN = -A (eps - eps_inf)^m   for eps > eps_inf, otherwise 0,
///
/// N the number of cycles and eps the range of the bond's stretch in a cycle.
struct LifeLaw {
  double coefficient = 0.0;  ///< A [1 per cycle]; 0: bonds do not age by this law
  double exponent = 1.0;     ///< m
  double limit = 0.0;        ///< eps_inf

  [[nodiscard]] bool acts() const { return coefficient > 0.0; }
  /// -d lambda / dN at a range of the stretch.
  [[nodiscard]] double rate(double range) const;
};

/// Options of mode fatigue.
struct FatigueOptions {
  LifeLaw nucleation{};  ///< of bonds that no crack is near
  LifeLaw growth{};      ///< of bonds near a crack
  /// Damage from which a point belongs to a crack: bonds that end within a horizon of it age by the
  /// law of growth.
  double crack_damage = 0.3;
  double load_ratio = 0.0;  ///< R: the least load of a cycle over the largest
  double cycles = 0.0;      ///< after which the run ends; 0: it goes on until the body fails
  int blocks = 0;           ///< likewise, of blocks of cycles; 0: no limit
  /// Bonds with no more life left than this at the end of a block break in it. 0: only those that
  /// tie with the first one.
  double life_tolerance = 0.0;

  /// Range of the stretch in a cycle of a body that is elastic in it: eps = |s_max - R s_max|.
  [[nodiscard]] double range(double largest_stretch) const;
  [[nodiscard]] const LifeLaw& law(bool near_crack) const {
    return near_crack ? growth : nucleation;
  }
};

/// Remaining lives of a body's bonds. A value.
struct RemainingLives {
  std::vector<double> life;      ///< per bond, 1 to 0; empty: no cycle has begun
  std::vector<char> near_crack;  ///< per bond, 1: it ages by the law of growth
};

/// Damage that the cuts of pre-cracks add.
struct InitialCuts {
  std::span<const double> weight;  ///< per point, see assess_damage; empty: none
  std::span<const BondEnds> bonds;
};

/// Bonds that have come near a crack, of which one end is within a horizon of a point with the
/// damage of a crack, change to the law of growth, once and for all. Their life begins anew with 1:
/// the law of growth counts it from the moment at which the crack tip comes within their horizon.
/// @param damage per point
/// @param broken 1 for bonds that keep their life
void note_cracks(const Bonds& bonds, std::span<const BondEnds> cut_bonds,
                 std::span<const double> damage, double crack_damage, std::span<const char> broken,
                 RemainingLives& lives);

/// Cycles after which the first bond has no life left, infinite if none ages.
/// @param rates per bond, 0 for those that do not age
[[nodiscard]] double cycles_to_first(std::span<const double> life, std::span<const double> rates);

/// Lives that are so near to one another are equal: equilibrium to 1e-10 of the forces leaves a
/// hundredth of it between symmetric bonds.
inline constexpr double life_tie = 1e-6;

/// Bonds that break at the end of a block, the most aged first, then by their numbers: those that
/// age and have no more life left than the tolerance. The set ends at a gap wider than a tie, if
/// there is one within ten ties.
[[nodiscard]] std::vector<Offset> worn_bonds(std::span<const double> life,
                                             std::span<const double> rates, double tolerance);

}  // namespace peristat
