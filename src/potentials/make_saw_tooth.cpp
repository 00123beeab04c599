#include "src/potentials/make_saw_tooth.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace peristat {
namespace {

/// Two ratios of stretches nearer than this differ by the round-off of a common factor.
constexpr double same_ratio = 1e-9;

/// Fraction of the band that is allowed at the strength of an undamaged bond.
constexpr double share_at_strength = 0.1;

/// Halvings of a bisection.
constexpr int halvings = 60;

/// Bisects for the value at which a condition that holds at the low end ceases to hold.
template <class Holds>
double last_of(double low, double high, const Holds& holds) {
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

/// Finds the secants of a law with the modulus 1.
class ToothMaker {
 public:
  explicit ToothMaker(const AnyBondLaw& law) : law_(law), bond_{1.0, law} {
    constexpr int samples = 1000;
    const double onset = law.onset(), range = law.critical() - onset;
    for (int k = 0; k <= samples; ++k) {
      largest_force_ = std::max(largest_force_, force(onset + range * k / samples));
    }
  }

  /// Teeth with the narrowest band that the number of teeth allows.
  [[nodiscard]] Teeth with_at_most(int most) const {
    const auto too_narrow = [&](double band) { return int(in_band(band).strength.size()) > most; };
    double wide = 1.0;
    while (too_narrow(wide)) wide *= 2.0;
    // The bisection ends just below the band at which the teeth suffice.
    constexpr double just_above = 1.0 + 1e-9;
    double band = last_of(0.0, wide, too_narrow) * just_above;
    while (too_narrow(band)) band *= just_above;
    Teeth teeth = in_band(band);
    for (double& strength : teeth.strength) strength /= law_.critical();
    return teeth;
  }

 private:
  [[nodiscard]] double force(double s) const { return law_.integrity(s) * s; }

  /// Stretch at which the drop from one secant to another dissipates what the law does between.
  [[nodiscard]] double strength(double from, double to) const {
    const double lost = law_.integrity(from) - law_.integrity(to);
    if (!(lost > 0.0)) return from;
    const double dissipated = bond_.dissipated(to) - bond_.dissipated(from);
    return std::clamp(std::sqrt(2.0 * dissipated / lost), from, to);
  }
  /// Excess of the force at the end of a secant over the law's there, relative to the largest
  /// force.
  [[nodiscard]] double above_law(double from, double to) const {
    const double s = strength(from, to);
    return (law_.integrity(from) * s - force(s)) / largest_force_;
  }

  /// The strength decides where a crack begins, so the first teeth are the finest.
  [[nodiscard]] double allowed_at(double from, double band) const {
    return band * std::max(share_at_strength, 1.0 - law_.integrity(from));
  }

  [[nodiscard]] Teeth in_band(double band) const {
    constexpr std::size_t endless = 100'000;
    Teeth teeth;
    const double end = law_.critical();
    for (double from = law_.onset(); from < end && teeth.strength.size() < endless;) {
      double to = end;
      const double allowed = allowed_at(from, band);
      if (above_law(from, end) > allowed) {
        to = last_of(from, end, [&](double at) { return above_law(from, at) <= allowed; });
      }
      // A law that falls steeply may need a drop that is higher than the band.
      if (!(to > from * (1.0 + 1e-9))) to = std::min(end, from + 1e-3 * (end - law_.onset()));
      const double s = strength(from, to);
      teeth.strength.push_back(s);
      teeth.integrity.push_back(law_.integrity(from));
      teeth.band = std::max(teeth.band, above_law(from, to));
      teeth.excess_strength =
          std::max(teeth.excess_strength, law_.integrity(from) * s / largest_force_ - 1.0);
      from = to;
    }
    // A broken bond has the critical stretch as its history, so the last strength stays below it.
    double& last = teeth.strength.back();
    last = std::min(last, end * (1.0 - 1e-9));
    return teeth;
  }

  const AnyBondLaw& law_;
  Degraded<AnyBondLaw> bond_;
  double largest_force_ = 0.0;
};

BondLaws with_teeth(const BondLaws& laws, int most) {
  struct Kind {
    std::size_t of;
    double ratio;
  };
  std::vector<Kind> kinds;
  std::vector<AnyBondLaw> toothed;
  std::vector<std::size_t> kind_of;
  for (Offset bond = 0; bond < laws.bonds(); ++bond) {
    const AnyBondLaw law = laws.at(bond);
    const Kind own{laws.law_of(bond), law.onset() / law.critical()};
    const auto known = std::ranges::find_if(kinds, [&](const Kind& kind) {
      return kind.of == own.of && std::abs(kind.ratio - own.ratio) <= same_ratio;
    });
    kind_of.push_back(std::size_t(known - kinds.begin()));
    if (known != kinds.end()) continue;
    if (kinds.size() == most_bond_laws) {
      throw std::length_error("too many laws of damage for a saw-tooth each");
    }
    kinds.push_back(own);
    toothed.push_back(saw_tooth(law, most));
  }
  BondLaws result(std::move(toothed), std::size_t(laws.bonds()));
  for (Offset bond = 0; bond < laws.bonds(); ++bond) {
    const AnyBondLaw law = laws.at(bond);
    result.set(bond, kind_of[std::size_t(bond)], law.onset(), law.critical());
  }
  return result;
}

}  // namespace

AnyBondLaw saw_tooth(const AnyBondLaw& law, int most) {
  if (law.falls_by_steps()) return law;
  return {
      SawTooth{std::make_shared<const Teeth>(ToothMaker(law).with_at_most(most)), law.critical()}};
}

BondPotential with_teeth(const BondPotential& potential, int most) {
  const auto toothed =
      [&]<class Law, class Whole>(const Degraded<Law, Whole>& bond) -> BondPotential {
    return std::visit(
        [&]<class Toothed>(const Toothed& law) -> BondPotential {
          return Degraded<Toothed, Whole>{bond.modulus, law, bond.shape};
        },
        saw_tooth({bond.law}, most).law);
  };
  const auto by_bond = [&]<class Whole>(const DegradedByBond<Whole>& bonds) -> BondPotential {
    DegradedByBond<Whole> result = bonds;
    result.laws = std::make_shared<const BondLaws>(with_teeth(*bonds.laws, most));
    return result;
  };
  return std::visit(
      [&]<class P>(const P& given) -> BondPotential {
        if constexpr (requires { toothed(given); }) {
          return toothed(given);
        } else if constexpr (requires { by_bond(given); }) {
          return by_bond(given);
        } else {
          return given;
        }
      },
      potential);
}

std::string description(const ToothedStrength& strength) {
  return fmt::format(
      "{} teeth, within {:.2g} % of the law's largest force, the strength {:.2g} % above",
      strength.teeth, 100.0 * strength.band, 100.0 * strength.excess_strength);
}

ToothedStrength toothed_strength(const BondPotential& potential) {
  ToothedStrength found;
  const auto look_at = [&](const AnyBondLaw& law) {
    const auto* const saw = std::get_if<SawTooth>(&law.law);
    if (!saw) return;
    found.teeth = std::max(found.teeth, int(saw->teeth->strength.size()));
    found.band = std::max(found.band, saw->teeth->band);
    found.excess_strength = std::max(found.excess_strength, saw->teeth->excess_strength);
  };
  std::visit(
      [&]<class P>(const P& given) {
        if constexpr (requires { given.laws; }) {
          for (Offset bond = 0; bond < given.laws->bonds(); ++bond) look_at(given.laws->at(bond));
        } else if constexpr (requires { given.law; }) {
          look_at({given.law});
        }
      },
      potential);
  return found;
}

}  // namespace peristat
