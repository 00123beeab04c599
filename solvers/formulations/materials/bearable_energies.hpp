#pragma once

#include "assembly/terms/linear/linear_term.hpp"
#include "solvers/formulations/materials/point_materials.hpp"

namespace peristat {

/// Energy that each point bears: W_c of its material, times its volume [J]; empty if no material
/// has the law energy_density. Points of the sets no_fail bear any.
/// @throws InputError if there is no such set
[[nodiscard]] BearableEnergies bearable_energies(const PointMaterials& materials,
                                                 const Points& points, double horizon);

}  // namespace peristat
