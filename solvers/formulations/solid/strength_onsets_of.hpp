#pragma once

#include <memory>

#include "assembly/terms/failure/strength_onsets.hpp"
#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// The strength surface of a material with these moduli.
[[nodiscard]] MaterialStrength material_strength(const DamageSpecification& damage,
                                                 const Moduli& moduli, int dimension);

/// The rule of a body's strength surfaces; null if no material has one.
/// @param moduli of the formulation
[[nodiscard]] std::shared_ptr<const StrengthOnsets> strength_onsets_of(
    const ModelSetting& setting, Formulation::OfMaterial<Moduli> moduli);

}  // namespace peristat
