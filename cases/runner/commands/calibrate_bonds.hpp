#pragma once

#include <string>

#include "solvers/study/body_specification.hpp"

namespace peristat {

/// Constants of bonds, what the lattice makes of them, and what a law of damage makes of a tear and
/// a pull, as JSON.
/// @param setting with or without a lattice
/// @param key     of the material, for errors
/// @throws InputError
[[nodiscard]] std::string bond_calibration(const MaterialSpecification& material,
                                           const std::string& key, const BondSetting& setting,
                                           double spacing);

/// What a law of damage makes of a tear and a pull, of bonds or of cpd, as JSON.
[[nodiscard]] std::string damage_calibration(const MaterialSpecification& material,
                                             const std::string& key, const BondSetting& setting,
                                             double spacing);

}  // namespace peristat
