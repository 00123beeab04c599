#pragma once

#include <vector>

#include "cases/runner/input/case.hpp"
#include "src/geometry/points.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Potential of the bonds of a case.
/// @param micromodulus c, or C1 of cpd [N/m6]
[[nodiscard]] BondPotential bond_potential(const MaterialSpecification& material,
                                           double micromodulus);

/// Micromodulus of the bonds of a case of model "bond" [N/m6].
[[nodiscard]] double micromodulus_of(const Case& from, const BondSetting& setting);

/// Flags of the bonds of the points of the sets that never fail; empty without such sets.
/// @throws InputError if there is no such set
[[nodiscard]] std::vector<char> never_failing_bonds(const Case& from, const Points& points,
                                                    const Bonds& bonds);

}  // namespace peristat
