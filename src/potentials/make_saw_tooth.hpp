#pragma once

#include <string>

#include "src/potentials/any_law.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Returns the saw-tooth of a law whose force falls smoothly; see SawTooth. A law that falls by
/// steps is returned as it is.
/// @param most largest number of teeth, at least 1
[[nodiscard]] AnyBondLaw saw_tooth(const AnyBondLaw& law, int most);

/// Returns a potential with the saw-teeth of its laws.
/// @throws std::length_error if the bonds' laws have more different ratios of their stretches than
///         most_bond_laws
[[nodiscard]] BondPotential with_teeth(const BondPotential& potential, int most);

/// Largest band and excess strength of the teeth of a potential's bonds; zero without teeth.
struct ToothedStrength {
  int teeth = 0;
  double band = 0.0, excess_strength = 0.0;
};
[[nodiscard]] ToothedStrength toothed_strength(const BondPotential& potential);

/// "10 teeth, within 12 % of the law's largest force, the strength 1.2 % above"
[[nodiscard]] std::string description(const ToothedStrength& strength);

}  // namespace peristat
