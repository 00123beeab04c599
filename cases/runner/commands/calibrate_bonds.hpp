#pragma once

#include <string>

#include "solvers/study/body_specification.hpp"

namespace peristat {

/// Constants of bonds, what the lattice makes of them, and what a law of damage makes of a tear and
/// a pull, as JSON.
/// @param setting with or without a lattice
/// @param with_strengths what a body bears under other stresses than a pull, too
/// @param key     of the material, for errors
/// @throws InputError
[[nodiscard]] std::string bond_calibration(const MaterialSpecification& material,
                                           const std::string& key, const BondSetting& setting,
                                           double spacing, bool with_strengths);

/// What a law of damage makes of a tear and a pull, of bonds or of cpd, as JSON.
[[nodiscard]] std::string damage_calibration(const MaterialSpecification& material,
                                             const std::string& key, const BondSetting& setting,
                                             double spacing, bool with_strengths);

/// @throws InputError if strengths are asked for where no law gives any
void require_law(const DamageSpecification& damage, bool with_strengths);

}  // namespace peristat
