#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/study/bond_materials.hpp"
#include "src/connectivity/crack.hpp"

namespace peristat {

/// The setting that the bonds of a body are made with: of a lattice that is convolved short bonds
/// alone, to the next neighbours along the axes and diagonals of planes.
[[nodiscard]] BondSetting network_setting(const BodySpecification& from, const Points& points,
                                          BondSetting setting);

/// Model of a body of model "bond" with linear kinematics, and what its pre-cracks have cut; or of
/// model "lps" as an energy or as it was printed, "green_bond" or "correspondence" by convolutions.
/// @param setting of all its bonds
/// @param bonds those of network_setting
/// @throws InputError ("solver.operator") for what is no convolution
[[nodiscard]] Model make_linear_model(const BodySpecification& from,
                                      const PointMaterials& materials, const PointFactors& factors,
                                      const Points& points, const BondSetting& setting, Bonds bonds,
                                      CutBonds& cut, int threads);

}  // namespace peristat
