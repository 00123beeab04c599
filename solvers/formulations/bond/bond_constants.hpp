#pragma once

#include <string>
#include <vector>

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// Refuses bonds without exactly one of youngs_modulus and micromodulus.
/// @throws InputError
void check_bond_constants(const MaterialSpecification& material, const std::string& key);

/// Refuses a calibration on the lattice for points without one.
/// @throws InputError ("material.calibration", …)
void require_lattice_to_calibrate_on(const BodySpecification& of, const Points& points);

/// The given modulus, calibrated on the lattice or in the continuum; a micromodulus by the
/// continuum.
[[nodiscard]] Moduli moduli_of_bonds(const MaterialSpecification& material, const std::string& key,
                                     const BondSetting& setting);

[[nodiscard]] std::vector<MaterialLine> describe_bonds(const PointMaterials::Material& material,
                                                       const BondSetting& setting);

}  // namespace peristat
