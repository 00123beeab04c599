#include "solvers/formulations/lps_energy/lps_energy.hpp"

#include <utility>

#include "solvers/formulations/lps_energy/convolved_solid.hpp"
#include "solvers/formulations/lps_energy/state_model.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

class LpsEnergyFormulation : public Formulation {
 public:
  [[nodiscard]] MaterialModel model() const override { return MaterialModel::lps; }
  [[nodiscard]] std::string label() const override { return "\"lps\" as an energy"; }
  [[nodiscard]] Capabilities capabilities() const override {
    const Options takes{Option::plane, Option::kinematics, Option::poisson_ratio,
                        Option::critical_stretch, Option::volume_correction, Option::form,
                        Option::pressures};
    Capabilities can{.takes = takes,
                     .takes_convolved =
                         takes
                             .with({Option::convolutions, Option::energy_density, Option::images})
                             .without({Option::critical_stretch, Option::pressures})};
    can.least_dimension = 2;
    can.default_influence = InverseInfluence::name;
    can.part_bonds = PartBonds::of_neighbours;
    can.couples_second_neighbours = true;
    return can;
  }

  void check(const MaterialSpecification& material, const std::string& key,
             int dimension) const override {
    check_solid_constants(material, key, dimension);
  }
  void check(const BodySpecification& of, const Points&) const override {
    require(of.form != SolidForm::printed || of.is_convolved(), "force_operator", "bonds",
            "does not go with the form \"printed\" of lps; take \"fft\"");
  }

  [[nodiscard]] BondSetting setting_of_bonds(BondSetting setting) const override {
    return state_setting(std::move(setting));
  }

  [[nodiscard]] MadeModel make_model(const ModelSetting& setting, Bonds bonds) const override {
    MadeModel made;
    made.model = setting.of.is_convolved()
                     ? make_convolved_solid(setting, std::move(bonds), made.cut)
                     : make_state_model(setting, std::move(bonds), made.cut);
    return made;
  }

  [[nodiscard]] std::optional<double> crack_energy_of_dilation(
      const MaterialSpecification& material, const BondSetting& setting) const override {
    return peristat::crack_energy_of_dilation(lame_constants(material, setting.dimension),
                                              state_setting(setting));
  }

  [[nodiscard]] Moduli moduli(const MaterialSpecification& material, const std::string&,
                              const BondSetting& setting, double) const override {
    return moduli_of_solid(material, setting.dimension);
  }
  [[nodiscard]] std::vector<MaterialLine> describe(const PointMaterials::Material& material,
                                                   const BondSetting& setting,
                                                   double) const override {
    return describe_solid(material, setting.dimension);
  }
};

}  // namespace

const Formulation& lps_energy_formulation() {
  static const LpsEnergyFormulation formulation;
  return formulation;
}

}  // namespace peristat
