#include "solvers/formulations/cpd/cpd.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "solvers/formulations/cpd/cpd_model.hpp"
#include "solvers/formulations/specification/require.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

/// The fracture scale, with a tear and a pull as far as they take no minutes. By release G_c = c A
/// times the work of the law, as with bonds alone: what a tear takes does not depend on its
/// triangles and tetrahedra.
FractureScale scale_of_cpd(const MaterialSpecification& material, const std::string& key,
                           const BondSetting& setting, double spacing) {
  FractureScale scale;
  scale.spacing = spacing;
  scale.youngs_modulus = material.youngs_modulus.value_or(0.0);
  const CpdConstants constants = cpd_constants_of(material, key, setting, spacing);
  const DamageDrive drive = material.damage.drive.value_or(release_by_energy(material.damage));
  refuse_damage_of_negative_constants(material, key, constants, setting, spacing, drive);
  scale.micromodulus = constants.c1;
  const bool is_by_release = drive == DamageDrive::release;
  const double largest = largest_ratio_of_tear(setting.dimension);
  const bool is_short = setting.horizon <= largest * spacing * (1.0 + horizon_tolerance);
  if (is_by_release || is_short) {
    const CpdConstants torn = is_by_release ? CpdConstants{constants.c1, 0.0, 0.0} : constants;
    scale.tear = std::make_shared<CpdTear>(setting, spacing, torn);
    scale.crossing = scale.tear->mean_crossing();
  } else if (material.damage.fracture_energy) {
    throw InputError(key + ".damage.fracture_energy", number_text(*material.damage.fracture_energy),
                     "is for horizon ratios up to " + number_text(largest) + " with cpd in " +
                         std::to_string(setting.dimension) +
                         "D and drive = \"stretch\": computing it for longer interactions takes "
                         "minutes; give stretches, or drive = \"release\"");
  }
  if (is_short) {
    scale.pull = std::make_shared<BulkPull>(setting, spacing, constants, is_by_release);
    if (!scale.pull->is_quick()) scale.pull.reset();
  }
  if (!material.damage.strength || scale.pull) return scale;
  throw InputError(key + ".damage.strength", number_text(*material.damage.strength),
                   "would take minutes to convert into stretches of cpd at this horizon ratio in " +
                       std::to_string(setting.dimension) + "D; give a shorter horizon, or onset");
}

std::string text_of_moduli(const char* where, const CpdStiffness& stiffness,
                           const CpdConstants& constants, int dimension) {
  const CubicElasticity elasticity = stiffness.elasticity(constants);
  const LameModuli moduli = elasticity.isotropic(dimension);
  return fmt::format(
      "{}: Young's modulus {:.6g} Pa, Poisson's ratio {:.4g} (along the axes {:.4g}), anisotropy "
      "{:.4g}",
      where, youngs_modulus_of(moduli, dimension), poisson_ratio_of(moduli, dimension),
      elasticity.axis_poisson_ratio(dimension), elasticity.anisotropy());
}

void check_cpd_material(const MaterialSpecification& material, const std::string& key,
                        int dimension) {
  require(material.youngs_modulus.has_value() != material.c1.has_value(), key, "",
          "needs a youngs_modulus with a poisson_ratio, or c1, and not both");
  require(material.poisson_ratio.has_value() == material.youngs_modulus.has_value(),
          key + ".poisson_ratio", "", "needs youngs_modulus");
  require(std::isfinite(material.c2), key + ".c2", number_text(material.c2), "must be finite");
  require(std::isfinite(material.c3), key + ".c3", number_text(material.c3), "must be finite");
  const bool has_moduli = material.youngs_modulus.has_value();
  require_absent(has_moduli && dimension == 2 && material.c2 != 0.0, key + ".c2",
                 "follows from youngs_modulus and poisson_ratio in 2D");
  require_absent((has_moduli || dimension == 2) && material.c3 != 0.0, key + ".c3",
                 has_moduli ? "follows from youngs_modulus and poisson_ratio" : "must be 0 in 2D");
}

/// In 2D nothing exists outside the plane: the moduli are those of plane stress.
Moduli moduli_of_cpd(const MaterialSpecification& material, const std::string& key,
                     const BondSetting& setting, double spacing) {
  const LameModuli of = stiffness_of(material, setting, spacing)
                            .moduli(cpd_constants_of(material, key, setting, spacing));
  return {youngs_modulus_of(of, setting.dimension), poisson_ratio_of(of, setting.dimension),
          setting.dimension == 2};
}

std::vector<MaterialLine> describe_cpd(const MaterialSpecification& material,
                                       const std::string& key, const BondSetting& setting,
                                       double spacing) {
  const CpdConstants constants = cpd_constants_of(material, key, setting, spacing);
  const int dimension = setting.dimension;
  std::vector<MaterialLine> lines;
  lines.push_back({"constants", fmt::format("C1 {:.6g} N/m6, C2 {:.6g} N/m10, C3 {:.6g} N/m14",
                                            constants.c1, constants.c2, constants.c3)});
  lines.push_back({"moduli", text_of_moduli("lattice", lattice_stiffness(setting, spacing),
                                            constants, dimension)});
  // Continuum moduli are not known with an influence function.
  if (setting.influence) return lines;
  lines.push_back({"moduli", text_of_moduli("continuum",
                                            continuum_stiffness(dimension, setting.horizon,
                                                                setting.cross_section),
                                            constants, dimension)});
  return lines;
}

std::string negative_constant_of(const MaterialSpecification& material, const std::string& key,
                                 const BondSetting& setting, double spacing) {
  return negative_constant(cpd_constants_of(material, key, setting, spacing));
}

}  // namespace

void require_whole_square_cells(const Points& points) {
  require(points.spacing.is_square(), "material.model", "cpd",
          "needs square or cubic cells: its constants and effective volumes are those of a cubic "
          "lattice; give one spacing, or model = \"bond\"");
  const auto is_cut = [&](double volume) {
    return points.cell_volume > 0.0 && std::abs(volume / points.cell_volume - 1.0) > 1e-9;
  };
  require(std::none_of(points.volume.begin(), points.volume.end(), is_cut), "material.model", "cpd",
          "needs whole cells: its effective volumes count neighbours, whatever their volume is; "
          "give points = \"lattice\" with volumes = \"cells\", or model = \"bond\"");
}

const Formulation& cpd_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::cpd,
      .label = "\"cpd\"",
      .takes = {Option::potential, Option::poisson_ratio, Option::constants, Option::calibration,
                Option::thermal_expansion, Option::strength, Option::softening,
                Option::critical_stretch, Option::weights, Option::interfaces, Option::eigenstrains,
                Option::pressures, Option::images, Option::contacts, Option::events, Option::drive},
      .least_dimension = 2,
      .part_bonds = PartBonds::among_neighbours,
      .most_points = [](int dimension) { return dimension + 1; },
      .largest_horizon_ratio = [](int dimension) { return largest_ratio_with_pairs(dimension); },
      .check_material = check_cpd_material,
      .check_body = [](const BodySpecification&,
                       const Points& points) { require_whole_square_cells(points); },
      // Effective volumes count every neighbour.
      .setting_of_bonds = without_influence,
      .make_model = make_cpd_model,
      .moduli = moduli_of_cpd,
      .describe = describe_cpd,
      .fracture_scale = scale_of_cpd,
      .default_drive = release_by_energy,
      .negative_constant = negative_constant_of};
  return formulation;
}

}  // namespace peristat
