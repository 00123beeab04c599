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

class LinearBondFormulation : public Formulation {
 public:
  [[nodiscard]] MaterialModel model() const override { return MaterialModel::bond; }
  [[nodiscard]] std::string label() const override {
    return "\"bond\" with kinematics \"linear\"";
  }
  [[nodiscard]] Capabilities capabilities() const override {
    const Options takes{Option::plane, Option::kinematics, Option::micromodulus,
                        Option::calibration, Option::thermal_expansion, Option::fibre,
                        Option::energy_density, Option::volume_correction, Option::horizon_shape,
                        Option::surface_correction, Option::interfaces, Option::given_neighbours,
                        Option::pressures, Option::images};
    Capabilities can{.takes = takes,
                     .takes_convolved =
                         takes.with({Option::convolutions}).without({Option::pressures})};
    can.part_needs_lattice = false;
    can.has_quadrature_of_bonds = true;
    can.has_elastic_stand_in = true;
    return can;
  }

  void check(const MaterialSpecification& material, const std::string& key, int) const override {
    check_bond_constants(material, key);
  }
  void check(const BodySpecification& of, const Points& points) const override {
    require_lattice_to_calibrate_on(of, points);
  }

  [[nodiscard]] MadeModel make_model(const ModelSetting& setting, Bonds bonds) const override {
    const BodySpecification& of = setting.of;
    const BondMaterials mixed(of, setting.materials, setting.factors, setting.points,
                              micromoduli(of, setting.materials, setting.bonds));
    CutBonds cut;
    std::optional<ConvolvedLattice> lattice;
    if (of.is_convolved()) {
      cut_short_bonds(bonds, setting);
      lattice = make_convolved_lattice(setting, setting.bonds, mixed.modulus(), cut,
                                       OtherOperator::bonds);
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

const Formulation& linear_bond_formulation() {
  static const LinearBondFormulation formulation;
  return formulation;
}

}  // namespace peristat
