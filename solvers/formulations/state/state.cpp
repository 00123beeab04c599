#include "solvers/formulations/state/state.hpp"

#include <memory>
#include <utility>

#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/specification/require.hpp"
#include "solvers/formulations/state/state_model.hpp"
#include "src/materials/bulk_bonds.hpp"
#include "src/materials/bulk_pull.hpp"

namespace peristat {
namespace {

/// lambda / mu from which dilatations, spread over the horizon, drive the bonds at a crack tip
/// late, and up to which they may.
constexpr double late_ratio = 2.5, most_ratio = 4.0;

double lame_ratio(const MaterialSpecification& material, int dimension) {
  const LamePair constants = lame_constants(material, dimension);
  return constants.lambda / constants.mu;
}

void check_material(const MaterialSpecification& material, const std::string& key, int dimension) {
  check_solid_constants(material, key, dimension);
  if (material.damage.law == DamageLaw::none) return;
  require(lame_ratio(material, dimension) <= most_ratio * (1.0 + 1e-9), key + ".poisson_ratio",
          number_text(*material.poisson_ratio),
          "is too near 1/2 for damage with model \"state\": cracks would run far above their "
          "fracture energy; take at most 0.4");
}

std::string warning_of_late_cracks(const MaterialSpecification& material, const std::string& key,
                                   const BondSetting& setting, double) {
  const double ratio = lame_ratio(material, setting.dimension);
  if (material.damage.law == DamageLaw::none || ratio <= late_ratio) return "";
  return key + ".poisson_ratio = " + number_text(*material.poisson_ratio) +
         ": a crack of model \"state\" needs more than the fracture energy to run where lambda/mu "
         "is above " +
         number_text(late_ratio) + "; here it is " + number_text(ratio);
}

/// G_c = c A times the work of the law: what a tear takes does not depend on lambda. Strengths do.
FractureScale scale_of_states(const MaterialSpecification& material, const std::string&,
                              const BondSetting& setting, double spacing) {
  const BondSetting of_states = state_setting(setting);
  FractureScale scale;
  scale.spacing = spacing;
  scale.micromodulus = micromodulus_of_states(material, setting);
  scale.crossing = mean_crossing(of_states);
  scale.youngs_modulus = *material.youngs_modulus;
  scale.pull = std::make_shared<BulkPull>(of_states, scale.micromodulus,
                                          lame_ratio(material, setting.dimension));
  return scale;
}

}  // namespace

const Formulation& state_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::state,
      .label = "\"state\"",
      .takes = {Option::plane, Option::poisson_ratio, Option::thermal_expansion,
                Option::volume_correction, Option::surface_correction, Option::eigenstrains,
                Option::pressures, Option::images, Option::strength, Option::softening,
                Option::critical_stretch},
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
                                    {Extension::finite, DamageDrive::release});
          },
      .moduli = moduli_of_solid,
      .describe = describe_solid,
      .fracture_scale = scale_of_states,
      .fracture_warning = warning_of_late_cracks};
  return formulation;
}

}  // namespace peristat
