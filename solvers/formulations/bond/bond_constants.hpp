#pragma once

#include <string>
#include <vector>

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

// Functions of formulations whose materials have the constants of bonds.

/// Refuses bonds without exactly one of youngs_modulus and micromodulus.
void check_bond_constants(const MaterialSpecification& material, const std::string& key, int);

/// Refuses a calibration on the lattice for points without one.
void require_lattice_to_calibrate_on(const BodySpecification& of, const Points& points);

/// The given modulus, calibrated on the lattice or in the continuum; a micromodulus by the
/// continuum.
[[nodiscard]] Moduli moduli_of_bonds(const MaterialSpecification& material, const std::string& key,
                                     const BondSetting& setting, double);

[[nodiscard]] std::vector<MaterialLine> describe_bonds(const MaterialSpecification& material,
                                                       const std::string& key,
                                                       const BondSetting& setting, double);

}  // namespace peristat
