#include "solvers/formulations/green_bond/green_bond.hpp"

#include <memory>
#include <utility>

#include "assembly/terms/points/convolved_term.hpp"
#include "solvers/formulations/bond/bond_constants.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/materials/bearable_energies.hpp"

namespace peristat {
namespace {

class GreenBondFormulation : public Formulation {
 public:
  [[nodiscard]] MaterialModel model() const override { return MaterialModel::green_bond; }
  [[nodiscard]] std::string label() const override { return "\"green_bond\""; }
  [[nodiscard]] Capabilities capabilities() const override {
    const Options takes{Option::plane,          Option::micromodulus,
                        Option::calibration,    Option::thermal_expansion,
                        Option::energy_density, Option::volume_correction,
                        Option::interfaces,     Option::convolutions,
                        Option::images};
    Capabilities can{.takes = takes, .takes_convolved = takes};
    can.needs_convolutions = true;
    return can;
  }

  void check(const MaterialSpecification& material, const std::string& key, int) const override {
    check_bond_constants(material, key);
  }

  [[nodiscard]] MadeModel make_model(const ModelSetting& setting, Bonds bonds) const override {
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

  [[nodiscard]] Moduli moduli(const MaterialSpecification& material, const std::string& key,
                              const BondSetting& setting, double) const override {
    return moduli_of_bonds(material, key, setting);
  }
  [[nodiscard]] std::vector<MaterialLine> describe(const PointMaterials::Material& material,
                                                   const BondSetting& setting,
                                                   double) const override {
    return describe_bonds(material, setting);
  }
};

}  // namespace

const Formulation& green_bond_formulation() {
  static const GreenBondFormulation formulation;
  return formulation;
}

}  // namespace peristat
