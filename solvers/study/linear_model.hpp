#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/ranks/part_of_body.hpp"
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
/// @param part of a body that these are, of bonds alone; null: it is whole
/// @throws InputError ("solver.operator") for what is no convolution
[[nodiscard]] Model make_linear_model(const BodySpecification& from,
                                      const PointMaterials& materials, const PointFactors& factors,
                                      const Points& points, const BondSetting& setting, Bonds bonds,
                                      CutBonds& cut, const PartOfBody* part, int threads);

/// The operator that sums a body's forces sooner, for a motion by explicit steps; of others, which
/// have more than forces to find, bonds. What convolutions alone sum is theirs.
[[nodiscard]] ForceOperator faster_operator(const BodySpecification& from, const Points& points,
                                            bool is_explicit);

}  // namespace peristat
