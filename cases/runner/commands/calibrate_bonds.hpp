#pragma once

#include <string>

#include "solvers/formulations/specification/body_specification.hpp"

namespace peristat {

/// Constants of bonds and their moduli on the lattice, or the constants of states, and fracture
/// energies and strengths of a law of damage, as JSON.
/// @param setting with or without a lattice
/// @param with_strengths adds strengths under other stresses than uniaxial tension
/// @param key     of the material, for errors
/// @throws InputError
[[nodiscard]] std::string bond_calibration(const MaterialSpecification& material,
                                           const std::string& key, const BondSetting& setting,
                                           double spacing, bool with_strengths);

/// Fracture energies and strengths of a law of damage, as JSON.
[[nodiscard]] std::string damage_calibration(const MaterialSpecification& material,
                                             const std::string& key, const BondSetting& setting,
                                             double spacing, bool with_strengths);

/// @throws InputError if strengths are requested of a law of damage that gives none
void require_law(const DamageSpecification& damage, bool with_strengths);

}  // namespace peristat
