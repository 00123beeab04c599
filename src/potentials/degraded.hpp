#pragma once

#include <algorithm>

#include "src/core/integral.hpp"
#include "src/core/lanes.hpp"
#include "src/potentials/harmonic.hpp"
#include "src/potentials/potential_density.hpp"

namespace peristat {

/// A bond that loses its stiffness as it is stretched, for good. With the potential phi_0 of the
/// whole bond, the integrity T(s) of a law, s the stretch and kappa the largest stretch over the
/// accepted states:
///
///   s <= kappa  phi' = T(kappa) phi_0'(s)   unloading and reloading along the secant
///   s >  kappa  phi' = T(s) phi_0'(s)       loading: damage would grow
///
/// phi is what the bond takes up from its unloaded state with the history kappa:
///
///   s <= kappa  phi = T(kappa) phi_0(s)                                      all of it stored
///   s >  kappa  phi = T(kappa) phi_0(kappa) + int_kappa^s T phi_0' dr        partly dissipated
///
/// so that force and tangent are derivatives of one energy while kappa is held, which it is between
/// accepted states. Of that energy T(max(s, kappa)) phi_0(s) is stored. For the harmonic potential
/// the force density is eq. 13 of [ADAPT] and phi'' for s > kappa its eqs. 14-15; the history is
/// ours: [ADAPT] evaluates T at the present stretch alone, which would let a bond heal.
///
/// A law is an aggregate with
///   onset(), critical()   stretches where damage begins and is complete,
///   integrity(s)          T: 1 up to the onset, 0 from the critical stretch on,
///   slope(s)              dT/ds,
///   work(whole, s)        int_0^s T phi_0' dr of the potentials for which it knows that in closed
///                         form; of the others it is integrated.
template <class Law, class Whole = Harmonic>
struct Degraded {
  double modulus = 0.0;  ///< of the whole bond
  Law law;
  Whole shape{1.0};           ///< its potential with the modulus 1
  bool holds_damage = false;  ///< phi' = T(kappa) phi_0'(s) at every stretch, also beyond kappa

  /// @param e stretch s
  /// @param largest_stretch kappa; `never_fails` for a bond that stays whole whatever happens
  [[nodiscard]] PotentialDensity<double> operator()(double e, double largest_stretch) const {
    if (holds_damage || !is_loading(e, largest_stretch)) {
      return whole(modulus * integrity_after(largest_stretch))(e);
    }
    const double before = std::max(largest_stretch, 0.0);
    const double integrity = law.integrity(e);
    const PotentialDensity<double> unit = shape(e);
    return {modulus * (whole(law.integrity(before))(before).value + work(e) - work(before)),
            whole(modulus * integrity)(e).first,
            modulus * (integrity * unit.second + unit.first * law.slope(e))};
  }

  [[nodiscard]] PotentialDensity<Lanes> operator()(const Lanes& e,
                                                   const Lanes& largest_stretch) const {
    const auto broken = largest_stretch >= law.critical();
    const auto degraded = std::experimental::max(e, largest_stretch) > law.onset();
    if (std::experimental::none_of(degraded && !broken)) {
      // Whole bonds and broken ones: nearly all there are.
      PotentialDensity<Lanes> result = whole(modulus)(e);
      for (Lanes* part : {&result.value, &result.first, &result.second}) {
        std::experimental::where(broken, *part) = 0.0;
      }
      return result;
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

  /// History of a bond that stays whole whatever happens.
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

  /// Energy density that the history has dissipated: int_0^kappa T phi_0' dr - T(kappa)
  /// phi_0(kappa)
  [[nodiscard]] double dissipated(double largest_stretch) const {
    if (!(largest_stretch > law.onset())) return 0.0;
    const double kappa = std::min(largest_stretch, law.critical());
    return modulus * (work(kappa) - whole(law.integrity(kappa))(kappa).value);
  }

 private:
  /// The whole bond with another modulus.
  [[nodiscard]] Whole whole(double its_modulus) const {
    Whole potential = shape;
    potential.modulus = its_modulus;
    return potential;
  }

  /// int_0^s T phi_0' dr for the modulus 1
  [[nodiscard]] double work(double s) const {
    if constexpr (requires { law.work(shape, s); }) {
      return law.work(shape, s);
    } else {
      const double elastic = std::min(s, law.onset()), end = std::min(s, law.critical());
      const auto force = [&](double r) { return law.integrity(r) * shape(r).first; };
      return shape(elastic).value + (end > elastic ? integral(force, elastic, end) : 0.0);
    }
  }
};

}  // namespace peristat
