#include "solvers/formulations/green_bond/green_bond.hpp"

#include <memory>
#include <utility>

#include "assembly/terms/points/convolved_term.hpp"
#include "solvers/formulations/bond/bond_constants.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/materials/bearable_energies.hpp"

namespace peristat {
namespace {

MadeModel make_green_bonds(const ModelSetting& setting, Bonds bonds) {
  cut_short_bonds(bonds, setting);
  const PointMaterials::Material& material = setting.materials.all().front();
  const double modulus = micromodulus_of(*material.of, material.key, setting.bonds).at(1.0);
  CutBonds cut;
  ConvolvedLattice lattice =
      make_convolved_lattice(setting, setting.bonds, modulus, cut, OtherOperator::none);
  return {Model(std::make_shared<ConvolvedTerm>(
              std::make_shared<const Bonds>(std::move(bonds)), modulus,
              bearable_energies(setting.materials, setting.points, setting.bonds.horizon),
              std::move(lattice), ConvolvedGreenBonds{}, setting.threads)),
          std::move(cut)};
}

constexpr OptionSet options_of_green_bonds{Option::plane,          Option::micromodulus,
                                           Option::calibration,    Option::thermal_expansion,
                                           Option::energy_density, Option::volume_correction,
                                           Option::interfaces,     Option::convolutions,
                                           Option::images};

}  // namespace

const Formulation& green_bond_formulation() {
  static const Formulation formulation{.model = MaterialModel::green_bond,
                                       .label = "\"green_bond\"",
                                       .takes = options_of_green_bonds,
                                       .takes_convolved = options_of_green_bonds,
                                       .needs_convolutions = true,
                                       .check_material = check_bond_constants,
                                       .make_model = make_green_bonds,
                                       .moduli = moduli_of_bonds,
                                       .describe = describe_bonds};
  return formulation;
}

}  // namespace peristat
