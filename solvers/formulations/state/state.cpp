#include "solvers/formulations/state/state.hpp"

#include <utility>

#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/state/state_model.hpp"
#include "src/materials/bulk_bonds.hpp"

namespace peristat {
namespace {

/// G_c = c A times the work of the law: what a tear takes does not depend on lambda.
FractureScale scale_of_states(const MaterialSpecification& material, const std::string&,
                              const BondSetting& setting, double spacing) {
  FractureScale scale;
  scale.spacing = spacing;
  scale.micromodulus = micromodulus_of_states(material, setting);
  scale.crossing = mean_crossing(state_setting(setting));
  scale.youngs_modulus = *material.youngs_modulus;
  return scale;
}

}  // namespace

const Formulation& state_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::state,
      .label = "\"state\"",
      .takes = {Option::plane, Option::poisson_ratio, Option::thermal_expansion,
                Option::volume_correction, Option::surface_correction, Option::eigenstrains,
                Option::pressures, Option::softening, Option::critical_stretch},
      .least_dimension = 2,
      .default_influence = InverseInfluence::name,
      .part_bonds = PartBonds::of_neighbours,
      .couples_second_neighbours = true,
      .check_material = check_solid_constants,
      .setting_of_bonds = state_setting,
      .make_model =
          [](const ModelSetting& setting, Bonds bonds) {
            return make_state_model(setting, std::move(bonds),
                                    {Extension::finite, DamageDrive::release});
          },
      .moduli = moduli_of_solid,
      .describe = describe_solid,
      .fracture_scale = scale_of_states};
  return formulation;
}

}  // namespace peristat
