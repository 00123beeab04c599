#include "solvers/formulations/correspondence/correspondence.hpp"

#include <memory>
#include <utility>

#include "assembly/convolutions/correspondence.hpp"
#include "assembly/terms/points/convolved_term.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/materials/bearable_energies.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

/// Micromodulus of bonds that have the same bulk modulus.
double modulus_of_bulk(const LamePair& constants, const BondSetting& setting) {
  const int d = setting.dimension;
  const LamePair of_bonds = lame_constants(1.0, poisson_ratio(setting), d, setting.plane);
  const auto bulk = [d](const LamePair& of) { return of.lambda + 2.0 * of.mu / d; };
  return micromodulus(bulk(constants) / bulk(of_bonds), setting);
}

/// Refuses points without a deformation gradient, whose neighbours all lie along a line or in a
/// plane.
void require_gradients(const Correspondence& material) {
  const std::size_t without = material.points_without_gradient();
  if (without == 0) return;
  throw InputError(
      "points", std::to_string(without),
      "of them have neighbours only along a line or in a plane, which determine no deformation "
      "gradient; resolve thin parts with more points, or take another model");
}

void check_correspondence(const MaterialSpecification& material, const std::string& key,
                          int dimension) {
  check_solid_constants(material, key, dimension);
  require_positive(material.stabilisation, key + ".stabilisation");
}

/// Its springs have the material's Young's modulus; beta is stabilisation times the micromodulus of
/// bonds of its bulk modulus, over the horizon ([FCBM] A-12, as a material of its own unit).
MadeModel make_correspondence(const ModelSetting& setting, Bonds bonds) {
  cut_short_bonds(bonds, setting);
  const Points& points = setting.points;
  const MaterialSpecification& material = *setting.materials.all().front().of;
  const double modulus = micromodulus(*material.youngs_modulus, setting.bonds);
  ConvolvedCorrespondence law;
  law.setting.volume = points.volume.front();
  law.arms = lattice_arms(setting.bonds, points.spacing, points.angle, law.setting.volume);
  law.setting.constants = lame_constants(material, points.dimension);
  law.setting.own = std::size_t(points.own());
  law.setting.stabilisation = material.stabilisation *
                              modulus_of_bulk(law.setting.constants, setting.bonds) /
                              setting.bonds.horizon;
  CutBonds cut;
  ConvolvedLattice lattice =
      make_convolved_lattice(setting, setting.bonds, modulus, cut, OtherOperator::none);
  require_gradients(Correspondence(lattice.box, {}, law.arms, law.setting, setting.threads));
  return {Model(std::make_shared<ConvolvedTerm>(
              std::make_shared<const Bonds>(std::move(bonds)), modulus,
              bearable_energies(setting.materials, points, setting.bonds.horizon),
              std::move(lattice), std::move(law), setting.threads)),
          std::move(cut)};
}

constexpr OptionSet options_of_correspondence{Option::plane,
                                              Option::poisson_ratio,
                                              Option::stabilisation,
                                              Option::energy_density,
                                              Option::volume_correction,
                                              Option::interfaces,
                                              Option::convolutions,
                                              Option::images};

}  // namespace

const Formulation& correspondence_formulation() {
  static const Formulation formulation{
      .model = MaterialModel::correspondence,
      .label = "\"correspondence\"",
      .takes = options_of_correspondence,
      .takes_convolved = options_of_correspondence,
      .needs_convolutions = true,
      .least_dimension = 2,
      // St. Venant and Kirchhoff's S_zz = lambda tr E is nu tr S at any strain.
      .across_plane = AcrossPlane::second_stress,
      .check_material = check_correspondence,
      .make_model = make_correspondence,
      .moduli = moduli_of_solid,
      .describe = describe_solid};
  return formulation;
}

}  // namespace peristat
