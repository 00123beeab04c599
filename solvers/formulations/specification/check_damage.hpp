#pragma once

#include <string>

#include "solvers/formulations/specification/material_specification.hpp"

namespace peristat {

/// Refuses a law of damage with too little or too much data, or with stretches that do not fit
/// together.
/// @param table key of the damage with a dot, "material.damage."
/// @throws InputError
void check_damage(const DamageSpecification& damage, const std::string& table);

}  // namespace peristat
