#include "solvers/formulations/lps_collocation/lps_collocation.hpp"

#include <utility>

#include <fmt/format.h>

#include "solvers/formulations/lps_collocation/collocation_model.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

/// Describes the weights of the quadrature.
std::string description(const CollocationSummary& of, int degree, Index points) {
  std::string text = fmt::format(
      "quadrature  exact to degree {}; weights solved for in {} of {} neighbourhoods, {} weights "
      "below 0, the lowest is {:.4g} of a cell",
      degree, of.solves, points, of.negative, of.lowest);
  if (of.lowered > 0) text += fmt::format("; exact only to a lower degree at {} points", of.lowered);
  return text;
}

class LpsCollocationFormulation : public Formulation {
 public:
  [[nodiscard]] MaterialModel model() const override { return MaterialModel::lps; }
  [[nodiscard]] std::string label() const override { return "\"lps\" by collocation"; }
  [[nodiscard]] Capabilities capabilities() const override {
    Capabilities can{.takes = {Option::plane, Option::kinematics, Option::poisson_ratio,
                               Option::critical_stretch, Option::form, Option::collocation,
                               Option::interfaces, Option::pressures, Option::surface_loads}};
    can.least_dimension = 2;
    can.default_influence = InverseInfluence::name;
    can.has_potential = false;
    can.part_bonds = PartBonds::of_neighbours;
    can.has_ghost_sites = true;
    return can;
  }

  void check(const MaterialSpecification& material, const std::string& key,
             int dimension) const override {
    check_solid_constants(material, key, dimension);
    require_absent(material.influence != ConstantInfluence::name &&
                       material.influence != InverseInfluence::name,
                   key + ".influence", "must be \"inverse\" with the model lps by collocation");
  }
  void check(const BodySpecification&, const Points& points) const override {
    require(points.lattice && points.spacing.is_square(), "material.model", "lps",
            "needs a lattice of squares or cubes: its sites fill up balls that reach over the "
            "surface");
  }

  /// The energy that its bonds dissipate depends on their length.
  [[nodiscard]] BondSetting setting_of_bonds(BondSetting setting) const override {
    setting.influence = {};
    return setting;
  }

  [[nodiscard]] MadeModel make_model(const ModelSetting& setting, Bonds bonds) const override {
    MadeModel made;
    CollocationSummary summary;
    made.model = make_collocation_model(setting, std::move(bonds), made.cut, summary);
    made.remarks = {
        description(summary, setting.of.collocation.degree, setting.points.count())};
    return made;
  }

  [[nodiscard]] std::optional<double> crack_energy_of_dilation(
      const MaterialSpecification& material, const BondSetting& setting) const override {
    return peristat::crack_energy_of_dilation(lame_constants(material, setting.dimension),
                                              setting.horizon, setting.dimension);
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

const Formulation& lps_collocation_formulation() {
  static const LpsCollocationFormulation formulation;
  return formulation;
}

}  // namespace peristat
