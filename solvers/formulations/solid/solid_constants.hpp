#pragma once

#include <string>

#include "solvers/formulations/interface/formulation.hpp"
#include "src/materials/lame_constants.hpp"

namespace peristat {

/// Constants of a material by E and nu [Pa].
[[nodiscard]] LamePair lame_constants(const MaterialSpecification& material, int dimension);

/// Refuses materials without E and nu, or with a nu at or beyond its limits.
/// @throws InputError
void check_solid_constants(const MaterialSpecification& material, const std::string& key,
                           int dimension);

/// Lame's constants, and the moduli that they were given by.
[[nodiscard]] std::vector<MaterialLine> describe_solid(const MaterialSpecification& material,
                                                       const std::string& key,
                                                       const BondSetting& setting, double);
[[nodiscard]] Moduli moduli_of_solid(const MaterialSpecification& material, const std::string& key,
                                     const BondSetting& setting, double);

/// Micromodulus of bonds that dissipate as much as a crack of the solid [N/m6].
/// @param crack_energy under a uniform dilation, over the squared stretch [J/m2]
[[nodiscard]] double modulus_of_crack(double crack_energy, const BondSetting& setting);

/// Constants per point with the random factors of stiffness.
[[nodiscard]] std::vector<LamePair> constants_of_points(const ModelSetting& setting);

}  // namespace peristat
