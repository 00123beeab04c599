#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/study/bond_materials.hpp"
#include "src/connectivity/crack.hpp"
#include "src/parallel/index_map.hpp"

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
/// @param index_map of a partitioned body, for bonds alone
/// @throws InputError ("force_operator") for forces that are no convolution
[[nodiscard]] Model make_linear_model(const BodySpecification& from,
                                      const PointMaterials& materials, const PointFactors& factors,
                                      const Points& points, const BondSetting& setting, Bonds bonds,
                                      CutBonds& cut, const IndexMap& index_map, int threads);

/// Returns the operator that sums a body's forces faster in a motion by explicit steps. Other runs,
/// which need more than forces, get bonds; models that only convolutions can sum get these.
[[nodiscard]] ForceOperator faster_operator(const BodySpecification& from, const Points& points,
                                            bool is_explicit);

}  // namespace peristat
