#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/ranks/part_of_body.hpp"
#include "solvers/study/bond_materials.hpp"
#include "src/connectivity/crack.hpp"
#include "src/materials/lame_constants.hpp"

namespace peristat {

/// What to tell of the quadrature of a body of model "lps".
struct CollocationSummary {
  Index negative = 0, lowered = 0, solves = 0;
  double lowest = 0.0;  ///< weight over the volume of a cell
};

/// Constants of a material of model "lps" [Pa].
[[nodiscard]] LamePair lame_constants(const MaterialSpecification& material, int dimension);

/// Stretch at which its bonds break so that a plane crack takes the fracture energy under a uniform
/// dilation, see crack_energy_of_dilation.
[[nodiscard]] double lps_critical_stretch(const MaterialSpecification& material,
                                          const BondSetting& setting, double fracture_energy);

/// Model of a body of model "lps", and what its pre-cracks have cut. Its bonds are those of a bond
/// model that dissipates as much.
/// @param part of a body that these are; null: it is whole
/// @throws InputError ("material.model") for points on no lattice of squares or cubes, and as
///         optimised_weights does
[[nodiscard]] Model make_collocation_model(const BodySpecification& from,
                                           const PointMaterials& materials,
                                           const PointFactors& factors, const Points& points,
                                           const BondSetting& setting, Bonds bonds, CutBonds& cut,
                                           CollocationSummary& summary, const PartOfBody* part,
                                           int threads);

}  // namespace peristat
