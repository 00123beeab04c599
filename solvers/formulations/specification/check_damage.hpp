#pragma once

#include <array>
#include <string>

#include "solvers/formulations/specification/material_specification.hpp"

namespace peristat {

/// True if the critical stretch follows from other data.
constexpr bool is_sized(const DamageSpecification& damage) {
  return damage.has_fracture_energy() || (damage.strength && !damage.softens());
}

/// True if a curve decides all of the law.
constexpr bool is_given_by_table(const DamageSpecification& damage) {
  return damage.law == DamageLaw::table;
}

/// When a datum of a law has no effect, and why.
struct DamageRule {
  const char* key;
  bool (*is_idle)(const DamageSpecification&);
  const char* why;
};
inline constexpr std::array<DamageRule, 27> damage_rules{
    {{"stretches", [](auto& damage) { return !is_given_by_table(damage); },
      "is for the law \"table\""},
     {"forces", [](auto& damage) { return !is_given_by_table(damage); },
      "is for the law \"table\""},
     {"fracture_energy", is_given_by_table, "follows from stretches and forces"},
     {"fracture_toughness", is_given_by_table, "follows from stretches and forces"},
     {"strength", is_given_by_table, "follows from stretches and forces"},
     {"critical", is_given_by_table, "is the last of stretches"},
     {"onset", is_given_by_table, "follows from stretches and forces"},
     {"fracture_toughness", [](auto& damage) { return damage.fracture_energy.has_value(); },
      "is another way to give fracture_energy; give one of them"},
     {"strength", [](auto& damage) { return damage.law == DamageLaw::energy_density; },
      "is for the laws of stretches"},
     {"drive", [](auto& damage) { return damage.law == DamageLaw::energy_density; },
      "is for the laws of stretches"},
     {"struts", [](auto& damage) { return damage.law == DamageLaw::energy_density; },
      "is for the laws of stretches"},
     {"compression", [](auto& damage) { return damage.law == DamageLaw::energy_density; },
      "is for the laws of stretches"},
     {"critical", [](auto& damage) { return damage.law == DamageLaw::energy_density; },
      "is for the laws of stretches"},
     {"critical", is_sized,
      "follows from fracture_energy, fracture_toughness or strength; give one of them"},
     {"onset", [](auto& damage) { return !damage.softens(); }, "is for the laws that soften"},
     {"onset", [](auto& damage) { return damage.strength && damage.law != DamageLaw::blended; },
      "follows from strength; give one of them"},
     {"peak", [](auto& damage) { return damage.law != DamageLaw::blended; },
      "is for the law \"blended\""},
     {"peak", [](auto& damage) { return damage.strength.has_value(); },
      "follows from strength; give one of them"},
     {"hardening", [](auto& damage) { return damage.law != DamageLaw::blended; },
      "is for the law \"blended\""},
     {"strength_surface", [](auto& damage) { return !damage.softens(); },
      "is for the laws that soften"},
     {"strength_surface", is_given_by_table,
      "is not for the law \"table\", whose stretches have a fixed ratio"},
     {"compressive_strength", [](auto& damage) { return !damage.has_surface(); },
      "needs strength_surface = \"drucker_prager\" or \"mohr_coulomb\""},
     {"compressive_strength",
      [](auto& damage) { return damage.strength_surface == StrengthCriterion::rankine; },
      "is not for the surface \"rankine\""},
     {"compressive_strength", [](auto& damage) { return damage.biaxial_strength.has_value(); },
      "follows from biaxial_strength; give one of them"},
     {"biaxial_strength",
      [](auto& damage) { return damage.strength_surface != StrengthCriterion::drucker_prager; },
      "is for strength_surface = \"drucker_prager\""},
     {"strength_factor", [](auto& damage) { return !damage.has_surface(); },
      "needs a strength_surface"},
     {"rate", [](auto& damage) { return !damage.has_rate(); },
      "is for the tanh laws and \"exponential\""}}};

/// Refuses a law of damage with too little or too much data, or with stretches that do not fit
/// together.
/// @param table key of the damage with a dot, "material.damage."
/// @throws InputError
void check_damage(const DamageSpecification& damage, const std::string& table);

}  // namespace peristat
