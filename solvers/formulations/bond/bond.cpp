#include "solvers/formulations/bond/bond.hpp"

#include <utility>

#include "solvers/formulations/bond/bond_constants.hpp"
#include "src/materials/bulk_bonds.hpp"

namespace peristat {
namespace {

class BondFormulation : public Formulation {
 public:
  [[nodiscard]] MaterialModel model() const override { return MaterialModel::bond; }
  [[nodiscard]] std::string label() const override {
    return "\"bond\" with kinematics \"finite\"";
  }
  [[nodiscard]] Capabilities capabilities() const override {
    Capabilities can{.takes = {Option::plane, Option::kinematics, Option::potential,
                               Option::micromodulus, Option::calibration,
                               Option::thermal_expansion, Option::fibre, Option::strength,
                               Option::softening, Option::critical_stretch,
                               Option::volume_correction, Option::horizon_shape,
                               Option::surface_correction, Option::interfaces,
                               Option::eigenstrains, Option::given_neighbours, Option::pressures,
                               Option::images, Option::events}};
    can.part_needs_lattice = false;
    can.has_quadrature_of_bonds = true;
    can.has_quick_fracture_scale = true;
    can.has_measured_trapping = true;
    can.has_elastic_stand_in = true;
    return can;
  }

  void check(const MaterialSpecification& material, const std::string& key, int) const override {
    check_bond_constants(material, key);
  }
  void check(const BodySpecification& of, const Points& points) const override {
    require_lattice_to_calibrate_on(of, points);
  }

  /// Surface corrections are those of the body without cracks and interfaces, which are no
  /// surfaces.
  [[nodiscard]] MadeModel make_model(const ModelSetting& setting, Bonds bonds) const override {
    const BodySpecification& of = setting.of;
    if (setting.points.own() < setting.points.count()) drop_weightless(bonds);
    const BondMaterials mixed(of, setting.materials, setting.factors, setting.points,
                              micromoduli(of, setting.materials, setting.bonds));
    if (!of.is_uniform()) {
      refuse_idle_interfaces(of, setting.materials, bonds, setting.index_map.ranks());
      mixed.weigh(bonds);
    }
    CutBonds cut = cut_bonds(bonds, setting.points, of.cracks);
    auto [potential, never_fails] = mixed.potential(bonds);
    return {Model(std::move(bonds), std::move(potential), std::move(never_fails)), std::move(cut)};
  }

  [[nodiscard]] std::optional<FractureScale> fracture_scale(const MaterialSpecification& material,
                                                            const std::string& key,
                                                            const BondSetting& setting,
                                                            double spacing) const override {
    FractureScale scale;
    scale.spacing = spacing;
    scale.micromodulus = micromodulus_of(material, key, setting).at(1.0);
    scale.crossing = mean_crossing(setting);
    scale.youngs_modulus =
        material.youngs_modulus.value_or(youngs_modulus_of(scale.micromodulus, setting));
    scale.pull = std::make_shared<BulkPull>(setting, scale.micromodulus);
    return scale;
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

const Formulation& bond_formulation() {
  static const BondFormulation formulation;
  return formulation;
}

}  // namespace peristat
