#pragma once

#include "assembly/terms/model.hpp"
#include "solvers/study/bond_materials.hpp"
#include "src/connectivity/crack.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Bond setting of a body of model "lps" with the form "energy": the influence is K(r) r / delta,
/// so that a bond stores as much in a dilation as one of the bond model.
/// @param setting with the influence K
[[nodiscard]] BondSetting state_setting(BondSetting setting);

/// Critical stretch with which a plane crack takes the fracture energy under a uniform
/// dilation, see crack_energy_of_dilation.
/// @param setting with the influence K
[[nodiscard]] double state_critical_stretch(const MaterialSpecification& material,
                                            const BondSetting& setting, double fracture_energy);

/// Makes the model of a body of model "lps" with the form "energy"; `cut` receives the bonds that
/// its pre-cracks have cut. Collective for a part.
/// @param setting see state_setting, with which the bonds were made
/// @param bonds of a part: those of_neighbours
/// @throws InputError ("material.model") for planes of symmetry, periods and given neighbours
[[nodiscard]] Model make_state_model(const BodySpecification& from, const PointMaterials& materials,
                                     const PointFactors& factors, const Points& points,
                                     const BondSetting& setting, Bonds bonds, CutBonds& cut,
                                     const IndexMap& index_map, int threads);

}  // namespace peristat
