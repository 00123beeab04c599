#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/study/bond_materials.hpp"
#include "src/connectivity/crack.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Summary of the quadrature of a body of model "lps", for reports.
struct CollocationSummary {
  Index negative = 0, lowered = 0, solves = 0;
  double lowest = 0.0;  ///< weight over the volume of a cell
};

/// Constants of a material of model "lps" [Pa].
[[nodiscard]] LamePair lame_constants(const MaterialSpecification& material, int dimension);

/// Critical stretch with which a plane crack takes the fracture energy under a uniform
/// dilation, see crack_energy_of_dilation.
[[nodiscard]] double lps_critical_stretch(const MaterialSpecification& material,
                                          const BondSetting& setting, double fracture_energy);

/// Makes the model of a body of model "lps"; `cut` receives the bonds that its pre-cracks have cut.
/// Its bonds are those of a bond model that dissipates as much.
/// @throws InputError ("material.model") for points on no lattice of squares or cubes, and as
///         optimised_weights does
[[nodiscard]] Model make_collocation_model(const BodySpecification& from,
                                           const PointMaterials& materials,
                                           const PointFactors& factors, const Points& points,
                                           const BondSetting& setting, Bonds bonds, CutBonds& cut,
                                           CollocationSummary& summary, const IndexMap& index_map,
                                           int threads);

}  // namespace peristat
