#include "solvers/formulations/linear_bond/linear_bond.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "assembly/terms/linear/linear_term.hpp"
#include "solvers/formulations/bond/bond_constants.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/materials/bearable_energies.hpp"

namespace peristat {
namespace {

MadeModel make_linear_bonds(const ModelSetting& setting, Bonds bonds) {
  const BodySpecification& of = setting.of;
  const BondMaterials mixed(of, setting.materials, setting.factors, setting.points,
                            micromoduli(of, setting.materials, setting.bonds));
  CutBonds cut;
  std::optional<ConvolvedLattice> lattice;
  if (of.is_convolved()) {
    cut_short_bonds(bonds, setting);
    lattice =
        make_convolved_lattice(setting, setting.bonds, mixed.modulus(), cut, OtherOperator::bonds);
  } else {
    if (setting.points.own() < setting.points.count()) drop_weightless(bonds);
    if (!of.is_uniform()) {
      refuse_idle_interfaces(of, setting.materials, bonds, setting.index_map.ranks());
      mixed.weigh(bonds);
    }
    cut = cut_bonds(bonds, setting.points, of.cracks);
  }
  return {Model(std::make_shared<LinearTerm>(
              std::make_shared<const Bonds>(std::move(bonds)), mixed.modulus(),
              bearable_energies(setting.materials, setting.points, setting.bonds.horizon),
              std::move(lattice), setting.threads)),
          std::move(cut)};
}

constexpr OptionSet options_of_linear_bonds{
    Option::plane,          Option::kinematics,         Option::micromodulus,
    Option::calibration,    Option::thermal_expansion,  Option::fibre,
    Option::energy_density, Option::volume_correction,  Option::horizon_shape,
    Option::interfaces,     Option::surface_correction, Option::given_neighbours,
    Option::horizons,       Option::pressures,          Option::images};

}  // namespace

const Formulation& linear_bond_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::bond,
      .label = "\"bond\" with kinematics \"linear\"",
      .takes = options_of_linear_bonds,
      .takes_convolved =
          options_of_linear_bonds.with({Option::convolutions}).without({Option::pressures}),
      .part_needs_lattice = false,
      .has_quadrature_of_bonds = true,
      .has_elastic_stand_in = true,
      .check_material = check_bond_constants,
      .check_body = require_lattice_to_calibrate_on,
      .make_model = make_linear_bonds,
      .moduli = moduli_of_bonds,
      .describe = describe_bonds};
  return formulation;
}

}  // namespace peristat
