#include "solvers/formulations/lps_collocation/lps_collocation.hpp"

#include "solvers/formulations/lps_collocation/collocation_model.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

void check_collocated_material(const MaterialSpecification& material, const std::string& key,
                               int dimension) {
  check_solid_constants(material, key, dimension);
  require_absent(
      material.influence != ConstantInfluence::name && material.influence != InverseInfluence::name,
      key + ".influence", "must be \"inverse\" with the model lps by collocation");
}

void require_square_lattice(const BodySpecification&, const Points& points) {
  require(points.lattice && points.spacing.is_square(), "material.model", "lps",
          "needs a lattice of squares or cubes, whose sites fill the neighbourhoods beyond the "
          "surface");
}

double energy_of_inverse_kernel(const MaterialSpecification& material, const std::string&,
                                const BondSetting& setting, double) {
  return crack_energy_of_dilation(lame_constants(material, setting.dimension), setting.horizon,
                                  setting.dimension);
}

}  // namespace

const Formulation& lps_collocation_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::lps,
      .label = "\"lps\" by collocation",
      .takes = {Option::plane, Option::kinematics, Option::poisson_ratio, Option::critical_stretch,
                Option::form, Option::collocation, Option::interfaces, Option::pressures,
                Option::surface_loads},
      .least_dimension = 2,
      .default_influence = InverseInfluence::name,
      .has_potential = false,
      .part_bonds = PartBonds::of_neighbours,
      .has_ghost_sites = true,
      .check_material = check_collocated_material,
      .check_body = require_square_lattice,
      // The energy that its bonds dissipate depends on their length.
      .setting_of_bonds = without_influence,
      .make_model = make_collocation_model,
      .moduli = moduli_of_solid,
      .describe = describe_solid,
      .crack_energy_of_dilation = energy_of_inverse_kernel};
  return formulation;
}

}  // namespace peristat
