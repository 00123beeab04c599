#pragma once

#include <algorithm>

#include "src/core/lanes.hpp"
#include "src/potentials/potential_density.hpp"

namespace peristat {

/// A bond that loses its stiffness as it is stretched, for good. With the integrity T(s) of a law,
/// s the stretch, c the micromodulus and kappa the largest stretch over the accepted states:
///
///   s <= kappa  phi' = c T(kappa) s   unloading and reloading along the secant
///   s >  kappa  phi' = c T(s) s       loading: damage would grow
///
/// phi is what the bond takes up from its unloaded state with the history kappa:
///
///   s <= kappa  phi = c T(kappa) s^2 / 2                                 all of it stored
///   s >  kappa  phi = c T(kappa) kappa^2 / 2 + c int_kappa^s r T(r) dr   partly dissipated
///
/// so that force and tangent are derivatives of one energy while kappa is held, which it is between
/// accepted states. Of that energy c T(max(s, kappa)) s^2 / 2 is stored. The force density is eq.
/// 13 of [ADAPT] and phi'' for s > kappa its eqs. 14-15; the history is ours: [ADAPT] evaluates T
/// at the present stretch alone, which would let a bond heal.
///
/// A law is an aggregate with
///   onset(), critical()   stretches where damage begins and is complete,
///   integrity(s)          T: 1 up to the onset, 0 from the critical stretch on,
///   slope(s)              dT/ds,
///   moment(s)             int_0^s r T(r) dr.
template <class Law>
struct Degraded {
  double modulus = 0.0;  ///< c [N/m6]
  Law law;
  bool holds_damage = false;  ///< phi' = c T(kappa) s at every stretch, also beyond kappa

  /// @param e stretch s
  /// @param largest_stretch kappa; `never_fails` for a bond that is harmonic whatever happens
  [[nodiscard]] PotentialDensity<double> operator()(double e, double largest_stretch) const {
    if (holds_damage || !is_loading(e, largest_stretch)) {
      const double secant = modulus * integrity_after(largest_stretch);
      return {0.5 * secant * e * e, secant * e, secant};
    }
    const double before = std::max(largest_stretch, 0.0);
    const double integrity = law.integrity(e);
    return {modulus * (0.5 * law.integrity(before) * before * before + law.moment(e) -
                       law.moment(before)),
            modulus * integrity * e, modulus * (integrity + e * law.slope(e))};
  }

  [[nodiscard]] PotentialDensity<Lanes> operator()(const Lanes& e,
                                                   const Lanes& largest_stretch) const {
    const auto broken = largest_stretch >= law.critical();
    const auto degraded = std::experimental::max(e, largest_stretch) > law.onset();
    if (std::experimental::none_of(degraded && !broken)) {
      // Whole bonds and broken ones: nearly all there are.
      Lanes secant = modulus;
      std::experimental::where(broken, secant) = 0.0;
      const Lanes first = secant * e;
      return {0.5 * first * e, first, secant};
    }
    PotentialDensity<Lanes> result;
    for (int l = 0; l < lane_count; ++l) {
      const PotentialDensity<double> one = (*this)(double(e[l]), double(largest_stretch[l]));
      result.value[l] = one.value;
      result.first[l] = one.first;
      result.second[l] = one.second;
    }
    return result;
  }

  /// History of a bond that is harmonic whatever happens.
  static constexpr double never_fails = -1.0;

  /// Whether an accepted state with this stretch would damage the bond further.
  [[nodiscard]] bool is_loading(double e, double largest_stretch) const {
    return e > law.onset() && e > largest_stretch && largest_stretch != never_fails &&
           !is_broken(largest_stretch);
  }

  /// Stretch over that beyond which the bond is damaged (further).
  [[nodiscard]] double utilisation(double e, double largest_stretch) const {
    if (largest_stretch == never_fails || is_broken(largest_stretch)) return 0.0;
    return e / std::max(law.onset(), largest_stretch);
  }

  [[nodiscard]] bool is_broken(double largest_stretch) const {
    return largest_stretch >= law.critical();
  }

  /// Integrity T(kappa) that is left.
  [[nodiscard]] double integrity_after(double largest_stretch) const {
    return law.integrity(std::max(largest_stretch, 0.0));
  }

  /// Energy density that the history has dissipated: c (int_0^kappa r T(r) dr - T(kappa) kappa^2/2)
  [[nodiscard]] double dissipated(double largest_stretch) const {
    if (!(largest_stretch > law.onset())) return 0.0;
    const double kappa = std::min(largest_stretch, law.critical());
    return modulus * (law.moment(kappa) - 0.5 * law.integrity(kappa) * kappa * kappa);
  }
};

}  // namespace peristat
