#pragma once

#include <string>

#include "solvers/formulations/specification/body_specification.hpp"

namespace peristat {

/// Constants of bonds, their moduli on the lattice, and fracture energies and strengths of a law of
/// damage, as JSON.
/// @param setting with or without a lattice
/// @param with_strengths adds strengths under other stresses than uniaxial tension
/// @param key     of the material, for errors
/// @throws InputError
[[nodiscard]] std::string bond_calibration(const MaterialSpecification& material,
                                           const std::string& key, const BondSetting& setting,
                                           double spacing, bool with_strengths);

/// Fracture energies and strengths of a law of damage, of bonds or of cpd, as JSON.
[[nodiscard]] std::string damage_calibration(const MaterialSpecification& material,
                                             const std::string& key, const BondSetting& setting,
                                             double spacing, bool with_strengths);

/// @throws InputError if strengths are requested of a law of damage that gives none
void require_law(const DamageSpecification& damage, bool with_strengths);

}  // namespace peristat
