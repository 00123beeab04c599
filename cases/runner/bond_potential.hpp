#pragma once

#include "cases/runner/case.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Potential of the bonds of a case.
/// @param micromodulus c, or C1 of cpd [N/m6]
[[nodiscard]] BondPotential bond_potential(const DamageSpecification& damage, double micromodulus);

}  // namespace peristat
