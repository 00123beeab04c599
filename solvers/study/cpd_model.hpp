#pragma once

#include <string>
#include <vector>

#include "assembly/terms/model.hpp"
#include "solvers/study/body_specification.hpp"
#include "solvers/study/bond_materials.hpp"
#include "solvers/study/point_materials.hpp"
#include "src/connectivity/crack.hpp"
#include "src/materials/cpd_constants.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Constants of a material of model "cpd": as given, or from E and nu by the lattice's bulk sums or
/// in the continuum.
/// @param key of the material, for errors
/// @throws InputError
[[nodiscard]] CpdConstants cpd_constants_of(const MaterialSpecification& material,
                                            const std::string& key, const BondSetting& setting,
                                            double spacing);

/// Key of a constant below zero, "c2" or "c3", whose interactions store negative energy; empty if
/// there is none.
[[nodiscard]] std::string negative_constant(const CpdConstants& constants);

/// @throws InputError ("….damage.law") for a negative constant: the triangles and tetrahedra that
///         are lost with a broken bond would release energy that was never supplied
void refuse_damage_of_negative_constants(const MaterialSpecification& material,
                                         const std::string& key, const CpdConstants& constants,
                                         const BondSetting& setting, double spacing);

/// Makes the model of a body of model "cpd". Collective for a part.
/// @throws InputError for damage together with a negative constant
/// @param bonds without weights yet
/// @param cut receives the bonds that pre-cracks have cut
/// @param bonds of a part: those among_neighbours
[[nodiscard]] Model make_cpd_model(const BodySpecification& from, const PointMaterials& materials,
                                   const PointFactors& factors, const Points& points,
                                   const BondSetting& setting, Bonds bonds, CutBonds& cut,
                                   const IndexMap& index_map, int threads);

}  // namespace peristat
