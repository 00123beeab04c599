#include "solvers/formulations/bond/bond.hpp"

#include <utility>

#include "solvers/formulations/bond/bond_constants.hpp"
#include "solvers/formulations/solid/strength_onsets_of.hpp"
#include "src/materials/bulk_bonds.hpp"

namespace peristat {
namespace {

/// Surface corrections are those of the body without cracks and interfaces, which are no surfaces.
MadeModel make_bond_model(const ModelSetting& setting, Bonds bonds) {
  const BodySpecification& of = setting.of;
  if (setting.points.own() < setting.points.count()) drop_weightless(bonds);
  const BondMaterials mixed(of, setting.materials, setting.factors, setting.points,
                            micromoduli(of, setting.materials, setting.bonds));
  if (!of.is_uniform()) {
    refuse_idle_interfaces(of, setting.materials, bonds, setting.index_map.ranks());
    mixed.weigh(bonds);
  }
  CutBonds cut = cut_bonds(bonds, setting.points, of.cracks);
  auto [potential, never_fails] =
      mixed.potential(bonds, fineness_of_bonds(setting.points, bonds, setting.bonds));
  const std::shared_ptr<const StrengthOnsets> onsets = strength_onsets_of(setting, moduli_of_bonds);
  const DamageDrive drive = onsets ? DamageDrive::release : DamageDrive::stretch;
  return {Model(std::move(bonds), std::move(potential), std::move(never_fails), drive, onsets),
          std::move(cut)};
}

FractureScale scale_of_bonds(const MaterialSpecification& material, const std::string& key,
                             const BondSetting& setting, double spacing) {
  FractureScale scale;
  scale.spacing = spacing;
  scale.micromodulus = micromodulus_of(material, key, setting).at(1.0);
  scale.crossing = mean_crossing(setting);
  scale.youngs_modulus =
      material.youngs_modulus.value_or(youngs_modulus_of(scale.micromodulus, setting));
  scale.pull = std::make_shared<BulkPull>(setting, scale.micromodulus);
  return scale;
}

}  // namespace

const Formulation& bond_formulation() {
  static const Formulation formulation{.model = MaterialModel::bond,
                                       .label = "\"bond\" with kinematics \"finite\"",
                                       .takes = {Option::plane,
                                                 Option::kinematics,
                                                 Option::potential,
                                                 Option::micromodulus,
                                                 Option::calibration,
                                                 Option::thermal_expansion,
                                                 Option::fibre,
                                                 Option::strength,
                                                 Option::strength_surface,
                                                 Option::struts,
                                                 Option::compression,
                                                 Option::softening,
                                                 Option::critical_stretch,
                                                 Option::volume_correction,
                                                 Option::horizon_shape,
                                                 Option::surface_correction,
                                                 Option::interfaces,
                                                 Option::eigenstrains,
                                                 Option::given_neighbours,
                                                 Option::horizons,
                                                 Option::pressures,
                                                 Option::images,
                                                 Option::contacts,
                                                 Option::events},
                                       .part_needs_lattice = false,
                                       .has_quadrature_of_bonds = true,
                                       .has_quick_fracture_scale = true,
                                       .has_measured_trapping = true,
                                       .has_elastic_stand_in = true,
                                       .check_material = check_bond_constants,
                                       .check_body = require_lattice_to_calibrate_on,
                                       .make_model = make_bond_model,
                                       .moduli = moduli_of_bonds,
                                       .describe = describe_bonds,
                                       .fracture_scale = scale_of_bonds};
  return formulation;
}

}  // namespace peristat
