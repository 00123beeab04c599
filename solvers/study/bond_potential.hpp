#pragma once

#include <vector>

#include "solvers/study/body_specification.hpp"
#include "src/geometry/points.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Potential of the bonds of a body.
/// @param micromodulus c, or C1 of cpd [N/m6]
[[nodiscard]] BondPotential bond_potential(const MaterialSpecification& material,
                                           double micromodulus);

/// Micromodulus of the bonds of a body of model "bond" [N/m6].
[[nodiscard]] double micromodulus_of(const BodySpecification& from, const BondSetting& setting);

/// Flags of the bonds of the points of the sets that never fail; empty without such sets.
/// @throws InputError if there is no such set
[[nodiscard]] std::vector<char> never_failing_bonds(const BodySpecification& from,
                                                    const Points& points, const Bonds& bonds);

}  // namespace peristat
