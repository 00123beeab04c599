#pragma once

#include <string>
#include <vector>

#include "solvers/formulations/interface/formulation.hpp"

namespace peristat {

/// A model of materials: its name in case files.
struct ModelName {
  MaterialModel model;
  const char* name;
};

/// All models, in the order in which pages list them.
[[nodiscard]] const std::vector<ModelName>& model_names();
[[nodiscard]] std::string name_of(MaterialModel model);

/// The formulation of a body.
[[nodiscard]] const Formulation& formulation_of(const BodySpecification& of);
/// One formulation of a model: all of a model take the same constants.
[[nodiscard]] const Formulation& formulation_of(const MaterialSpecification& material);

/// Options of a formulation with any of its operators.
[[nodiscard]] OptionSet all_options_of(const Formulation& formulation);
/// Options of a body, with convolutions if it has them.
[[nodiscard]] OptionSet options_of(const BodySpecification& of);
[[nodiscard]] inline bool takes(const BodySpecification& of, Option option) {
  return options_of(of).has(option);
}
/// True if a formulation of the model takes the option.
[[nodiscard]] bool takes(MaterialModel model, Option option);

/// "is for models \"bond\" and \"cpd\"": those that take the option.
[[nodiscard]] std::string is_for(Option option);

/// What drives the damage of a material of the formulation.
[[nodiscard]] DamageDrive drive_of(const Formulation& formulation,
                                   const DamageSpecification& damage);
/// Says in each material with a law what drives its damage, where there is a choice.
void resolve_drives(BodySpecification& of);

/// Scale of the fracture energy and strength of a material without fibres, of a formulation with
/// such a scale.
[[nodiscard]] FractureScale fracture_scale_of(const MaterialSpecification& material,
                                              const std::string& key, const BondSetting& setting,
                                              double spacing);

/// The law of a material with stretches in the place of its data, see with_stretches of a law, and
/// with a strength surface the factors of its peaks.
[[nodiscard]] DamageSpecification damage_with_stretches(const MaterialSpecification& material,
                                                        const std::string& key,
                                                        const BondSetting& setting, double spacing,
                                                        const FractureScale& scale);

/// Modulus E' of a crack of mode I, G = K^2 / E': E in plane stress, E / (1 - nu^2) in plane strain
/// and 3D, by the moduli of the material's model [Pa].
[[nodiscard]] double modulus_of_tip(const MaterialSpecification& material, const std::string& key,
                                    const BondSetting& setting, double spacing);

/// The material with the fracture energy K^2 / E' in the place of a toughness K.
[[nodiscard]] MaterialSpecification with_fracture_energy(MaterialSpecification material,
                                                         const std::string& key,
                                                         const BondSetting& setting,
                                                         double spacing);

/// The body with stretches in the place of fracture energies and strengths.
/// @param spacing  of points with the setting's horizon [m]
/// @param fineness the setting's horizon over the smallest one
/// @throws InputError as the with_stretches of a law does
[[nodiscard]] BodySpecification with_stretches(BodySpecification of, const BondSetting& setting,
                                               double spacing, double fineness = 1.0);

}  // namespace peristat
