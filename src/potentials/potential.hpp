#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>
#include <variant>

#include "src/core/lanes.hpp"
#include "src/potentials/critical_stretch.hpp"
#include "src/potentials/degraded.hpp"
#include "src/potentials/force_envelope.hpp"
#include "src/potentials/force_table.hpp"
#include "src/potentials/harmonic.hpp"
#include "src/potentials/opening_law.hpp"
#include "src/potentials/saw_tooth.hpp"
#include "src/potentials/tanh_degradation.hpp"

namespace peristat {

/// A scalar law: the density of a potential from the relative change of its measure, over double
/// and over Lanes; linear in its modulus.
template <class P>
concept Potential = std::is_aggregate_v<P> &&
    requires(const P potential, double number, Lanes lanes) {
  { potential.modulus } -> std::convertible_to<double>;
  { P::name } -> std::convertible_to<std::string_view>;
  { potential(number) } -> std::same_as<PotentialDensity<double>>;
  { potential(lanes) } -> std::same_as<PotentialDensity<Lanes>>;
};

/// A scalar law that also depends on the largest stretch that the bond has had, and possibly on the
/// bond.
template <class P>
concept PotentialWithHistory = requires(const P potential, Offset bond, double number,
                                        Lanes lanes) {
  { potential.of_bond(bond)(number, number) } -> std::same_as<PotentialDensity<double>>;
  { potential(lanes, lanes, bond) } -> std::same_as<PotentialDensity<Lanes>>;
  { potential.of_bond(bond).is_loading(number, number) } -> std::same_as<bool>;
};

/// Potentials of undamaged bonds, each also with every law of damage, and with laws that differ
/// from bond to bond.
template <Potential... Whole>
struct BondPotentials {
  using Any = std::variant<Whole..., Degraded<CriticalStretch, Whole>...,
                           Degraded<TanhDegradation, Whole>..., Degraded<ForceEnvelope, Whole>...,
                           Degraded<ForceTable, Whole>..., Degraded<OpeningLaw, Whole>...,
                           Degraded<SawTooth, Whole>..., DegradedByBond<Whole>...>;

  /// Calls visit(potential) for each of them, with the modulus 1.
  template <class Visit>
  static void for_each(const Visit& visit) {
    (visit(Whole{1.0}), ...);
  }
};

/// The list of potentials that an undamaged bond can have; a case file chooses by their names.
using WholeBondPotentials = BondPotentials<Harmonic>;

/// Every potential that a bond can have; the choice is made once, outside the loop over bonds.
using BondPotential = WholeBondPotentials::Any;

/// Every potential that a triangle or tetrahedron can have.
using HigherPotential = std::variant<Harmonic>;

}  // namespace peristat
