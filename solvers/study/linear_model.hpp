#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/ranks/part_of_body.hpp"
#include "solvers/study/bond_materials.hpp"
#include "src/connectivity/crack.hpp"

namespace peristat {

/// Setting with which the bonds of a body are made: for a convolved lattice short bonds alone, to
/// the next neighbours along the axes and diagonals of planes.
[[nodiscard]] BondSetting network_setting(const BodySpecification& from, const Points& points,
                                          BondSetting setting);

/// Makes the model of a body of model "bond" with linear kinematics, or, by convolutions, of model
/// "lps" as an energy or as it was printed, "green_bond" or "correspondence". `cut` receives the
/// bonds that its pre-cracks have cut.
/// @param setting of all its bonds
/// @param bonds those of network_setting
/// @param part of a partitioned body, of bonds alone; null: the body is not partitioned
/// @throws InputError ("force_operator") for forces that are no convolution
[[nodiscard]] Model make_linear_model(const BodySpecification& from,
                                      const PointMaterials& materials, const PointFactors& factors,
                                      const Points& points, const BondSetting& setting, Bonds bonds,
                                      CutBonds& cut, const PartOfBody* part, int threads);

/// Returns the operator that sums a body's forces faster in a motion by explicit steps. Other runs,
/// which need more than forces, get bonds; models that only convolutions can sum get these.
[[nodiscard]] ForceOperator faster_operator(const BodySpecification& from, const Points& points,
                                            bool is_explicit);

}  // namespace peristat
