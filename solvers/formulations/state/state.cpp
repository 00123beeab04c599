#include "solvers/formulations/state/state.hpp"

#include <memory>
#include <utility>

#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/solid/strength_onsets_of.hpp"
#include "solvers/formulations/specification/require.hpp"
#include "solvers/formulations/state/state_model.hpp"

namespace peristat {
namespace {

void check_material(const MaterialSpecification& material, const std::string& key, int dimension) {
  check_solid_constants(material, key, dimension);
  if (material.damage.law == DamageLaw::none) return;
  require(material.damage.drive != DamageDrive::stretch, key + ".damage.drive", "stretch",
          "must be \"release\" with model \"state\"");
  check_release_of_states(material, key, dimension);
}

std::string warning_of_states(const MaterialSpecification& material, const std::string& key,
                              const BondSetting& setting, double) {
  return material.damage.law == DamageLaw::none ? ""
                                                : warning_of_late_cracks(material, key, setting);
}

}  // namespace

const Formulation& state_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::state,
      .label = "\"state\"",
      .takes = {Option::plane, Option::poisson_ratio, Option::thermal_expansion,
                Option::volume_correction, Option::surface_correction, Option::eigenstrains,
                Option::pressures, Option::images, Option::contacts, Option::strength,
                Option::softening, Option::critical_stretch, Option::drive,
                Option::strength_surface, Option::events},
      .least_dimension = 2,
      .default_influence = InverseInfluence::name,
      .part_bonds = PartBonds::of_neighbours,
      .couples_second_neighbours = true,
      .has_quick_fracture_scale = true,
      .check_material = check_material,
      .setting_of_bonds = state_setting,
      .make_model =
          [](const ModelSetting& setting, Bonds bonds) {
            return make_state_model(setting, std::move(bonds),
                                    {Extension::finite, DamageDrive::release,
                                     strength_onsets_of(setting, moduli_of_solid)});
          },
      .moduli = moduli_of_solid,
      .describe = describe_solid,
      .fracture_scale = scale_of_states,
      .default_drive = [](const DamageSpecification&) { return DamageDrive::release; },
      .fracture_warning = warning_of_states};
  return formulation;
}

}  // namespace peristat
