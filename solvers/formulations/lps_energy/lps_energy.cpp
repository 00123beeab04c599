#include "solvers/formulations/lps_energy/lps_energy.hpp"

#include <memory>
#include <utility>

#include "assembly/terms/linear/linear_term.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/materials/bearable_energies.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/specification/require.hpp"
#include "solvers/formulations/state/state_model.hpp"

namespace peristat {
namespace {

void check_form(const BodySpecification& of, const Points&) {
  require(of.form != SolidForm::printed || of.is_convolved(), "force_operator", "bonds",
          "is not allowed with the form \"printed\" of lps; take \"fft\"");
}

/// Makes a solid by convolutions. Its springs have the solid's Young's modulus and influence.
MadeModel make_convolved_solid(const ModelSetting& setting, Bonds bonds) {
  cut_short_bonds(bonds, setting);
  const Points& points = setting.points;
  const MaterialSpecification& material = *setting.materials.all().front().of;
  const BondSetting of_springs = state_setting(setting.bonds);
  const double modulus = micromodulus(*material.youngs_modulus, of_springs);
  const double volume = points.volume.front();
  const bool is_printed = setting.of.form == SolidForm::printed;
  MadeModel made;
  ConvolvedLattice lattice =
      make_convolved_lattice(setting, of_springs, modulus, made.cut,
                             is_printed ? OtherOperator::none : OtherOperator::bonds);
  made.model = Model(std::make_shared<LinearTerm>(
      std::make_shared<const Bonds>(std::move(bonds)), modulus,
      bearable_energies(setting.materials, points, setting.bonds.horizon), std::move(lattice),
      setting.threads,
      ConvolvedSolid{
          lattice_arms(setting.bonds, points.spacing, points.angle, volume),
          {lame_constants(material, points.dimension), volume,
           is_printed ? SolidForces::printed : SolidForces::energy, std::size_t(points.own())}}));
  return made;
}

double energy_of_dilation(const MaterialSpecification& material, const std::string&,
                          const BondSetting& setting, double) {
  return crack_energy_of_dilation(lame_constants(material, setting.dimension),
                                  state_setting(setting));
}

bool is_by_release(const DamageSpecification& damage) {
  return damage.breaks_bonds() &&
         damage.drive.value_or(release_by_energy(damage)) == DamageDrive::release;
}

void check_lps_material(const MaterialSpecification& material, const std::string& key,
                        int dimension) {
  check_solid_constants(material, key, dimension);
  if (is_by_release(material.damage)) return check_release_of_states(material, key, dimension);
  require_absent(material.damage.softens(), key + ".damage.law",
                 "must be \"critical_stretch\" with drive \"stretch\" of model \"lps\"");
}

std::string warning_of_lps(const MaterialSpecification& material, const std::string& key,
                           const BondSetting& setting, double) {
  return is_by_release(material.damage) ? warning_of_late_cracks(material, key, setting) : "";
}

MadeModel make_solid(const ModelSetting& setting, Bonds bonds) {
  if (setting.of.is_convolved()) return make_convolved_solid(setting, std::move(bonds));
  bool releases = false;
  for (const auto& material : all_materials(setting.of, setting.materials)) {
    releases |= is_by_release(material.of->damage);
  }
  return make_state_model(
      setting, std::move(bonds),
      {Extension::linear, releases ? DamageDrive::release : DamageDrive::stretch});
}

constexpr OptionSet options_of_states{Option::plane, Option::kinematics, Option::poisson_ratio,
                                      Option::form, Option::volume_correction};

}  // namespace

const Formulation& lps_energy_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::lps,
      .label = "\"lps\" as an energy",
      .takes = options_of_states.with(
          {Option::critical_stretch, Option::softening, Option::drive, Option::pressures}),
      .takes_convolved =
          options_of_states.with({Option::convolutions, Option::energy_density, Option::images}),
      .least_dimension = 2,
      .default_influence = InverseInfluence::name,
      .part_bonds = PartBonds::of_neighbours,
      .couples_second_neighbours = true,
      .check_material = check_lps_material,
      .check_body = check_form,
      .setting_of_bonds = state_setting,
      .make_model = make_solid,
      .moduli = moduli_of_solid,
      .describe = describe_solid,
      .fracture_scale = scale_of_states,
      .crack_energy_of_dilation = energy_of_dilation,
      .default_drive = release_by_energy,
      .fracture_warning = warning_of_lps};
  return formulation;
}

}  // namespace peristat
