#pragma once

#include <algorithm>
#include <limits>
#include <memory>

#include "src/core/integral.hpp"
#include "src/core/lanes.hpp"
#include "src/core/types.hpp"
#include "src/potentials/bond_laws.hpp"
#include "src/potentials/harmonic.hpp"
#include "src/potentials/potential_density.hpp"
#include "src/potentials/stepwise_law.hpp"

namespace peristat {

/// History of a bond that is never damaged.
inline constexpr double never_failing = -1.0;

/// The density of a batch of bonds. Nearly all of them are undamaged or broken; each one is
/// evaluated by itself only if some bond is neither.
/// @param range of their laws, see DamageRange
/// @param whole the potential of the undamaged bonds
/// @param closes see Degraded
/// @param of_lane(l) density of one of them
template <class Real, class Whole, class OfLane>
[[nodiscard, gnu::always_inline]] inline PotentialDensity<Lanes> degraded_batch(
    const Lanes& e, const Lanes& largest_stretch, const DamageRange<Real>& range,
    const Whole& whole, bool closes, const OfLane& of_lane) {
  auto broken = largest_stretch >= range.critical;
  auto degraded = max(e, largest_stretch) > range.onset;
  if (closes) {
    const auto is_open = e > Lanes(0.0);
    broken = broken && is_open;
    degraded = degraded && is_open;
  }
  PotentialDensity<Lanes> result;
  if (none_of(degraded && !broken)) {
    result = whole(e);
    // One by one: a loop over their addresses would move them out of their registers.
    result.value = chosen(broken, 0.0, result.value);
    result.first = chosen(broken, 0.0, result.first);
    result.second = chosen(broken, 0.0, result.second);
    return result;
  }
  for (int l = 0; l < lane_count; ++l) {
    const PotentialDensity<double> one = of_lane(l);
    result.value.set(l, one.value);
    result.first.set(l, one.first);
    result.second.set(l, one.second);
  }
  return result;
}

/// A bond that loses its stiffness for good as it is stretched. With the potential phi_0 of the
/// undamaged bond, the integrity T(s) of a law, s the stretch and kappa the largest stretch over
/// the accepted states:
///
///   s <= kappa  phi' = T(kappa) phi_0'(s)   unloading and reloading along the secant
///   s >  kappa  phi' = T(s) phi_0'(s)       loading: damage would grow
///
/// phi is the energy density that the bond takes up from its unloaded state with the history kappa:
///
///   s <= kappa  phi = T(kappa) phi_0(s)                                      all of it stored
///   s >  kappa  phi = T(kappa) phi_0(kappa) + int_kappa^s T phi_0' dr        partly dissipated
///
/// so that force and tangent are derivatives of one energy while kappa is held, as it is between
/// accepted states. The part T(max(s, kappa)) phi_0(s) of that energy is stored. For the harmonic
/// potential the force density is eq. 13 of [ADAPT] and phi'' for s > kappa its eqs. 14-15. The
/// history is not from [ADAPT], which evaluates T at the present stretch alone, so that a bond
/// would heal.
///
/// A law is an aggregate with
///   onset(), critical()   stretches where damage begins and is complete,
///   integrity(s)          T: 1 up to the onset, 0 from the critical stretch on,
///   slope(s)              dT/ds,
///   work(whole, s)        int_0^s T phi_0' dr for the potentials with a closed form; for others it
///                         is integrated numerically.
template <class Law, class Whole = Harmonic>
struct Degraded {
  double modulus = 0.0;  ///< of the undamaged bond
  Law law;
  Whole shape{1.0};           ///< its potential with the modulus 1
  bool holds_damage = false;  ///< phi' = T(kappa) phi_0'(s) at every stretch, also beyond kappa
  bool closes = false;        ///< phi = phi_0 where s < 0: damage takes the tension alone

  /// @param e stretch s
  /// @param largest_stretch kappa; `never_fails` for a bond that is never damaged
  [[nodiscard]] PotentialDensity<double> operator()(double e, double largest_stretch) const {
    if (closes && !(e > 0.0)) return whole(modulus)(e);
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

  /// @param first the batch's first bond
  [[nodiscard, gnu::always_inline]] PotentialDensity<Lanes> operator()(const Lanes& e,
                                                                       const Lanes& largest_stretch,
                                                                       Offset first = 0) const {
    return degraded_batch(e, largest_stretch, ranges(first), whole(modulus), closes,
                          [&](int l) { return (*this)(double(e[l]), double(largest_stretch[l])); });
  }

  /// The potential of one of the bonds, here the same for all; see DegradedByBond.
  [[nodiscard]] const Degraded& of_bond(Offset) const { return *this; }
  [[nodiscard]] DamageRange<double> ranges(Offset) const { return {law.onset(), law.critical()}; }
  [[nodiscard]] double onset_of(Offset) const { return law.onset(); }
  [[nodiscard]] double bytes() const { return 0.0; }

  static constexpr double never_fails = never_failing;

  /// True if accepting a state with this stretch would damage the bond further.
  [[nodiscard]] bool is_loading(double e, double largest_stretch) const {
    return e > law.onset() && e > largest_stretch && largest_stretch != never_fails &&
           !is_broken(largest_stretch);
  }

  /// Stretch beyond which the bond is damaged (further); infinite if it is broken or never fails.
  [[nodiscard]] double borne(double largest_stretch) const {
    if (largest_stretch == never_fails || is_broken(largest_stretch)) {
      return std::numeric_limits<double>::infinity();
    }
    return std::max(law.onset(), largest_stretch);
  }

  /// Utilisation ratio: the stretch over `borne`.
  [[nodiscard]] double utilisation(double e, double largest_stretch) const {
    return e / borne(largest_stretch);
  }

  [[nodiscard]] bool is_broken(double largest_stretch) const {
    return largest_stretch >= law.critical();
  }

  /// Remaining integrity T(kappa).
  [[nodiscard]] double integrity_after(double largest_stretch) const {
    return law.integrity(std::max(largest_stretch, 0.0));
  }

  /// Integrity that the bond loses at once when it exceeds what it bears; 0 if its force falls
  /// smoothly.
  [[nodiscard]] double drop_after(double largest_stretch) const {
    const double integrity = integrity_after(largest_stretch);
    if (falls_by_steps(law)) {
      return integrity - law.integrity(borne_after(law, borne(largest_stretch)));
    }
    return law.onset() < law.critical() ? 0.0 : integrity;
  }

  /// Energy density that the history has dissipated: int_0^kappa T phi_0' dr - T(kappa)
  /// phi_0(kappa)
  [[nodiscard]] double dissipated(double largest_stretch) const {
    // A brittle bond is broken at the stretch where its damage begins.
    if (!(largest_stretch > law.onset()) && !is_broken(largest_stretch)) return 0.0;
    const double kappa = std::min(largest_stretch, law.critical());
    return modulus * (work(kappa) - whole(law.integrity(kappa))(kappa).value);
  }

 private:
  /// Potential of the undamaged bond with another modulus.
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

/// Bonds that lose their stiffness like Degraded ones, each by a law of its own, between stretches
/// that are the law's or, where a strength surface moves them, a history's.
template <class Whole = Harmonic>
struct DegradedByBond {
  double modulus = 0.0;  ///< of the undamaged bonds
  std::shared_ptr<const BondLaws> laws;
  Whole shape{1.0};                  ///< their potential with the modulus 1
  bool holds_damage = false;         ///< see Degraded
  bool closes = false;               ///< likewise
  const double* onset = nullptr;     ///< of the bonds; null: the laws' own
  const double* critical = nullptr;  ///< likewise

  static constexpr double never_fails = never_failing;

  [[nodiscard]] Degraded<AnyBondLaw, Whole> of_bond(Offset bond) const {
    return {modulus, onset ? laws->at(bond, onset[bond], critical[bond]) : laws->at(bond), shape,
            holds_damage, closes};
  }
  [[nodiscard]] DamageRange<Lanes> ranges(Offset first) const {
    if (onset) return {Lanes(onset + first), Lanes(critical + first)};
    return laws->ranges(first);
  }
  [[nodiscard]] double onset_of(Offset bond) const {
    return onset ? onset[bond] : laws->onset_of(bond);
  }
  [[nodiscard]] double bytes() const { return laws->bytes(); }

  [[nodiscard]] PotentialDensity<Lanes> operator()(const Lanes& e, const Lanes& largest_stretch,
                                                   Offset first) const {
    Whole whole = shape;
    whole.modulus = modulus;
    return degraded_batch(e, largest_stretch, ranges(first), whole, closes, [&](int l) {
      return of_bond(first + l)(double(e[l]), double(largest_stretch[l]));
    });
  }
};

}  // namespace peristat
