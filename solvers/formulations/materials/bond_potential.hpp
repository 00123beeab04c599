#pragma once

#include <memory>
#include <vector>

#include "solvers/formulations/materials/point_materials.hpp"
#include "solvers/formulations/specification/body_specification.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Law of damage with its numbers; for `none`, the law of a bond that is broken from the start.
[[nodiscard]] AnyLaw law_of(const DamageSpecification& damage);

/// Potential of the bonds of a body.
/// @param micromodulus c, or C1 of cpd [N/m6]
[[nodiscard]] BondPotential bond_potential(const MaterialSpecification& material,
                                           double micromodulus);

/// The same potential with a law of damage for each bond.
/// @throws std::logic_error if its bonds never fail
[[nodiscard]] BondPotential with_laws(const BondPotential& failing,
                                      std::shared_ptr<const BondLaws> laws);

/// Flags of bonds with a point in one of the no_fail sets of any material, which never fail; empty
/// without such sets.
/// @throws InputError if there is no such set
[[nodiscard]] std::vector<char> never_failing_bonds(
    const std::vector<PointMaterials::Material>& materials, const Points& points,
    const Bonds& bonds);

}  // namespace peristat
