#include "solvers/formulations/formulations.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "solvers/formulations/bond/bond.hpp"
#include "solvers/formulations/correspondence/correspondence.hpp"
#include "solvers/formulations/cpd/cpd.hpp"
#include "solvers/formulations/green_bond/green_bond.hpp"
#include "solvers/formulations/linear_bond/linear_bond.hpp"
#include "solvers/formulations/lps_collocation/lps_collocation.hpp"
#include "solvers/formulations/lps_energy/lps_energy.hpp"
#include "solvers/formulations/materials/bond_potential.hpp"
#include "solvers/formulations/solid/strength_onsets_of.hpp"
#include "solvers/formulations/specification/for_each_material.hpp"
#include "solvers/formulations/state/state.hpp"

namespace peristat {
namespace {

/// The one list of formulations.
const std::vector<const Formulation*>& all_formulations() {
  static const std::vector<const Formulation*> all{
      &bond_formulation(),       &linear_bond_formulation(),   &cpd_formulation(),
      &state_formulation(),      &lps_energy_formulation(),    &lps_collocation_formulation(),
      &green_bond_formulation(), &correspondence_formulation()};
  return all;
}

/// Names of those that take an option: a model, or the formulation if its model has others that do
/// not.
std::vector<std::string> names_with(Option option) {
  std::vector<std::string> names;
  for (const auto& [model, name] : model_names()) {
    std::vector<std::string> of_model;
    bool all_take = true;
    for (const Formulation* formulation : all_formulations()) {
      if (formulation->model != model) continue;
      if (!all_options_of(*formulation).has(option)) {
        all_take = false;
      } else if (formulation->takes.has(option) || option == Option::convolutions) {
        of_model.push_back(std::string(formulation->label));
      } else {
        of_model.push_back(std::string(formulation->label) + " with operator \"fft\"");
        all_take = false;
      }
    }
    if (all_take) of_model = {'"' + std::string(name) + '"'};
    names.insert(names.end(), of_model.begin(), of_model.end());
  }
  return names;
}

}  // namespace

const std::vector<ModelName>& model_names() {
  static const std::vector<ModelName> names{{MaterialModel::bond, "bond"},
                                            {MaterialModel::cpd, "cpd"},
                                            {MaterialModel::state, "state"},
                                            {MaterialModel::lps, "lps"},
                                            {MaterialModel::green_bond, "green_bond"},
                                            {MaterialModel::correspondence, "correspondence"}};
  return names;
}

std::string name_of(MaterialModel model) {
  return std::ranges::find(model_names(), model, &ModelName::model)->name;
}

const Formulation& formulation_of(const MaterialSpecification& material) {
  if (material.model == MaterialModel::bond && material.kinematics == Kinematics::linear) {
    return linear_bond_formulation();
  }
  return **std::ranges::find(all_formulations(), material.model, &Formulation::model);
}

const Formulation& formulation_of(const BodySpecification& of) {
  const bool is_collocated =
      of.material.model == MaterialModel::lps && of.form == SolidForm::collocation;
  return is_collocated ? lps_collocation_formulation() : formulation_of(of.material);
}

OptionSet all_options_of(const Formulation& formulation) {
  return formulation.takes.with(formulation.takes_convolved.value_or(OptionSet{}));
}

OptionSet options_of(const BodySpecification& of) {
  const Formulation& formulation = formulation_of(of);
  return of.is_convolved() ? formulation.takes_convolved.value_or(formulation.takes)
                           : formulation.takes;
}

bool takes(MaterialModel model, Option option) {
  return std::ranges::any_of(all_formulations(), [&](const Formulation* formulation) {
    return formulation->model == model && all_options_of(*formulation).has(option);
  });
}

std::string is_for(Option option) {
  const std::vector<std::string> names = names_with(option);
  std::string text = names.size() == 1 ? "is for model " : "is for models ";
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  }
  if (option == Option::poisson_ratio) {
    text += "; bonds alone have 1/3 in plane stress, 1/4 in plane strain and 3D";
  }
  return text;
}

DamageDrive drive_of(const Formulation& formulation, const DamageSpecification& damage) {
  if (damage.drive) return *damage.drive;
  return formulation.default_drive ? formulation.default_drive(damage) : DamageDrive::stretch;
}

void resolve_drives(BodySpecification& of) {
  const Formulation& formulation = formulation_of(of);
  if (!takes(of, Option::drive)) return;
  for_each_material(of, [&](MaterialSpecification& material, const std::string&) {
    DamageSpecification& damage = material.damage;
    if (damage.breaks_bonds()) damage.drive = drive_of(formulation, damage);
  });
}

FractureScale fracture_scale_of(const MaterialSpecification& material, const std::string& key,
                                const BondSetting& setting, double spacing) {
  const Formulation& formulation = formulation_of(material);
  if (!formulation.fracture_scale) throw std::logic_error("a formulation without fracture scale");
  return formulation.fracture_scale(material, key, setting, spacing);
}

DamageSpecification damage_with_stretches(const MaterialSpecification& material,
                                          const std::string& key, const BondSetting& setting,
                                          double spacing, const FractureScale& scale) {
  DamageSpecification damage = with_stretches(material.damage, key, scale);
  if (!damage.has_surface()) return damage;
  const Moduli moduli = formulation_of(material).moduli(material, key, setting, spacing);
  damage.peak_factors = std::make_shared<const PeakFactors>(
      *scale.pull, law_of(damage), material_strength(damage, moduli, setting.dimension));
  return damage;
}

double modulus_of_tip(const MaterialSpecification& material, const std::string& key,
                      const BondSetting& setting, double spacing) {
  const Moduli of = formulation_of(material).moduli(material, key, setting, spacing);
  const double nu = of.poisson_ratio;
  return of.is_thin ? of.youngs_modulus : of.youngs_modulus / (1.0 - nu * nu);
}

MaterialSpecification with_fracture_energy(MaterialSpecification material, const std::string& key,
                                           const BondSetting& setting, double spacing) {
  DamageSpecification& damage = material.damage;
  if (!damage.fracture_toughness) return material;
  const double toughness = *damage.fracture_toughness;
  damage.fracture_energy =
      toughness * (toughness / modulus_of_tip(material, key, setting, spacing));
  damage.fracture_toughness.reset();
  return material;
}

namespace {

/// Stretches of a material by horizon, if they are not proportional to the root of 1 / horizon.
std::vector<LawStretches> by_horizon(const MaterialSpecification& material, const std::string& key,
                                     const BondSetting& setting, double spacing, double fineness) {
  const DamageSpecification& damage = material.damage;
  const bool keeps_shape = !damage.strength && damage.onset == 0.0 && damage.peak == 0.0;
  if (!(fineness > 1.0) || !damage.fracture_energy || keeps_shape) return {};
  std::vector<LawStretches> all;
  const int last = int(std::ceil(horizon_steps * std::log2(fineness)));
  for (int k = 0; k <= last; ++k) {
    const double finer = std::exp2(double(k) / horizon_steps);
    BondSetting own = setting;
    own.horizon /= finer;
    if (own.cloud) own.cloud->size /= finer;
    const DamageSpecification found =
        with_stretches(damage, key, fracture_scale_of(material, key, own, spacing / finer));
    all.push_back({found.onset, found.critical});
  }
  return all;
}

/// Finds the stretches of a material from its data.
void find_stretches(const Formulation& formulation, MaterialSpecification& material,
                    const std::string& key, const BondSetting& setting, double spacing,
                    double fineness) {
  material = with_fracture_energy(std::move(material), key, setting, spacing);
  if (material.damage.law == DamageLaw::table)
    material.damage = with_stretches(material.damage, key, {});
  if (!material.damage.is_by_data()) return;
  const bool is_by_stretch = drive_of(formulation, material.damage) == DamageDrive::stretch;
  if (formulation.crack_energy_of_dilation && is_by_stretch) {
    const double energy = formulation.crack_energy_of_dilation(material, key, setting, spacing);
    material.damage.critical = std::sqrt(*material.damage.fracture_energy / energy);
    material.damage.fracture_energy.reset();
    return;
  }
  const FractureScale scale = fracture_scale_of(material, key, setting, spacing);
  const bool is_by_energy = material.damage.fracture_energy.has_value();
  std::vector<LawStretches> of_horizons = by_horizon(material, key, setting, spacing, fineness);
  material.damage = damage_with_stretches(material, key, setting, spacing, scale);
  material.damage.is_by_energy = is_by_energy;
  material.damage.of_horizons = std::move(of_horizons);
}

}  // namespace

BodySpecification with_stretches(BodySpecification of, const BondSetting& setting, double spacing,
                                 double fineness) {
  const Formulation& formulation = formulation_of(of);
  resolve_drives(of);
  for_each_material(of, [&](MaterialSpecification& material, const std::string& key) {
    find_stretches(formulation, material, key, setting, spacing, fineness);
  });
  return of;
}

}  // namespace peristat
