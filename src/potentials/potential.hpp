#pragma once

#include <concepts>
#include <type_traits>
#include <variant>

#include "src/core/lanes.hpp"
#include "src/potentials/critical_stretch.hpp"
#include "src/potentials/degraded.hpp"
#include "src/potentials/harmonic.hpp"
#include "src/potentials/tanh_degradation.hpp"

namespace peristat {

/// A scalar law: the density of a potential from the relative change of its measure, over double
/// and over Lanes.
template <class P>
concept Potential = std::is_aggregate_v<P> &&
    requires(const P potential, double number, Lanes lanes) {
  { potential(number) } -> std::same_as<PotentialDensity<double>>;
  { potential(lanes) } -> std::same_as<PotentialDensity<Lanes>>;
};

/// A scalar law that also depends on the largest stretch that the bond has had.
template <class P>
concept PotentialWithHistory = requires(const P potential, double number, Lanes lanes) {
  { potential(number, number) } -> std::same_as<PotentialDensity<double>>;
  { potential(lanes, lanes) } -> std::same_as<PotentialDensity<Lanes>>;
  { potential.is_loading(number, number) } -> std::same_as<bool>;
};

/// Every potential that a bond can have; the choice is made once, outside the loop over bonds.
using BondPotential = std::variant<Harmonic, Degraded<CriticalStretch>, Degraded<TanhDegradation>>;

/// Every potential that a triangle or tetrahedron can have.
using HigherPotential = std::variant<Harmonic>;

}  // namespace peristat
