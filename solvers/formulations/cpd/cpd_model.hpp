#pragma once

#include <string>

#include "solvers/formulations/interface/formulation.hpp"
#include "src/materials/cpd_constants.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"

namespace peristat {

/// Moduli of the constants on the lattice, or in the continuum if the material says so.
[[nodiscard]] CpdStiffness stiffness_of(const MaterialSpecification& material,
                                        const BondSetting& setting, double spacing);

/// Constants of a material of model "cpd": as given, or from E and nu by the lattice's bulk sums or
/// in the continuum.
/// @param key of the material, for errors
/// @throws InputError
[[nodiscard]] CpdConstants cpd_constants_of(const MaterialSpecification& material,
                                            const std::string& key, const BondSetting& setting,
                                            double spacing);

/// Key of a constant below zero, "c2" or "c3", whose interactions store negative energy; empty if
/// there is none.
[[nodiscard]] std::string negative_constant(const CpdConstants& constants);

/// @throws InputError ("….damage.law") for a negative constant if stretch drives damage: the
///         triangles and tetrahedra that are lost with a broken bond would release energy that was
///         never supplied. By release, for a negative Poisson's ratio: such triangles hold bonds
///         back so long that a tear takes several times the fracture energy
void refuse_damage_of_negative_constants(const MaterialSpecification& material,
                                         const std::string& key, const CpdConstants& constants,
                                         const BondSetting& setting, double spacing,
                                         DamageDrive drive);

/// Makes the model. Collective for a part.
/// @param bonds without weights yet; of a part those among_neighbours
/// @throws InputError for damage that its constants or the body do not allow
[[nodiscard]] MadeModel make_cpd_model(const ModelSetting& setting, Bonds bonds);

}  // namespace peristat
