#pragma once

#include <concepts>
#include <type_traits>
#include <variant>

#include "src/lanes.hpp"
#include "src/potentials/harmonic.hpp"

namespace peristat {

/// A scalar law: the density of a potential from the relative change of its measure, over double
/// and over Lanes.
template <class P>
concept Potential = std::is_aggregate_v<P> &&
    requires(const P potential, double number, Lanes lanes) {
  { potential(number) } -> std::same_as<PotentialDensity<double>>;
  { potential(lanes) } -> std::same_as<PotentialDensity<Lanes>>;
};

/// Every potential that a bond can have; the choice is made once, outside the loop over bonds.
using BondPotential = std::variant<Harmonic>;

/// Every potential that a triangle or tetrahedron can have.
using HigherPotential = std::variant<Harmonic>;

}  // namespace peristat
