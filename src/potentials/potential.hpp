#pragma once

#include <concepts>
#include <type_traits>
#include <variant>

#include "src/lanes.hpp"
#include "src/potentials/harmonic.hpp"

namespace peristat {

/// A scalar law: value, first and second derivative from the reference measure and the relative
/// change of the measure, over double and over Lanes.
template <class P>
concept Potential = std::is_aggregate_v<P> &&
    requires(const P potential, double number, Lanes lanes) {
  { potential(number, number) } -> std::same_as<PotentialValue<double>>;
  { potential(lanes, lanes) } -> std::same_as<PotentialValue<Lanes>>;
};

/// Every potential that a bond can have; the choice is made once, outside the loop over bonds.
using BondPotential = std::variant<Harmonic>;

}  // namespace peristat
