#include "solvers/study/state_model.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include "assembly/terms/states/state_term.hpp"
#include "src/core/input_error.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/neighbourhood/influence.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

LamePair constants_of(const MaterialSpecification& material, int dimension) {
  return lame_constants(*material.youngs_modulus, *material.poisson_ratio, dimension,
                        material.plane);
}

/// Micromodulus of bonds that dissipate as much as a crack of the solid.
double modulus_of_crack(const MaterialSpecification& material, const BondSetting& setting) {
  const double energy =
      crack_energy_of_dilation(constants_of(material, setting.dimension), setting);
  return 4.0 * energy / (mean_of_magnitude(setting.dimension) * setting.moment(2));
}

void refuse_what_has_no_states(const Points& points) {
  const auto refuse = [](const std::string& what) {
    throw InputError("material.model", "lps", what);
  };
  if (points.own() < points.count()) refuse("does not go with planes of symmetry and periods");
  if (!points.neighbours.empty()) refuse("finds its own neighbours");
}

}  // namespace

BondSetting state_setting(BondSetting setting) {
  if (!setting.influence) {
    setting.influence = [](double x) { return x; };
    return setting;
  }
  setting.influence = [kernel = std::move(setting.influence)](double x) { return x * kernel(x); };
  return setting;
}

double state_critical_stretch(const MaterialSpecification& material, const BondSetting& setting,
                              double fracture_energy) {
  const LamePair constants = constants_of(material, setting.dimension);
  return std::sqrt(fracture_energy / crack_energy_of_dilation(constants, state_setting(setting)));
}

Model make_state_model(const BodySpecification& from, const PointMaterials& materials,
                       const PointFactors& factors, const Points& points,
                       const BondSetting& setting, Bonds bonds, CutBonds& cut,
                       const IndexMap& index_map, int threads) {
  refuse_what_has_no_states(points);
  std::vector<DirectedConstant> moduli;
  std::vector<LamePair> of_material;
  for (const auto& material : all_materials(from, materials)) {
    moduli.push_back({{modulus_of_crack(*material.of, setting), 0.0, 0.0}, {}});
    of_material.push_back(constants_of(*material.of, points.dimension));
  }
  StateShares shares;
  for (Index i = 0; i < points.count(); ++i) {
    const auto& [lambda, mu] = of_material[materials.of(i)];
    const double factor = factors.stiffness.empty() ? 1.0 : factors.stiffness[std::size_t(i)];
    shares.constants.push_back({factor * lambda, factor * mu});
  }
  shares.moment = moments_of(points, bonds, kernel_of_weights(bonds));
  const BondMaterials mixed(from, materials, factors, points, std::move(moduli));
  if (!from.is_uniform()) {
    // The kernel of the states does not depend on materials; the energy that bonds dissipate does.
    refuse_idle_interfaces(from, materials, bonds, index_map.ranks());
    Bonds plain = bonds;
    static_cast<void>(cut_bonds(plain, points, from.cracks));
    shares.kernel = kernel_of_weights(plain);
    mixed.weigh(bonds);
  }
  cut = cut_bonds(bonds, points, from.cracks);
  if (from.is_uniform()) shares.kernel = kernel_of_weights(bonds);
  auto [potential, never_fails] = mixed.potential(bonds);
  return Model(std::make_shared<StateTerm>(std::make_shared<const Bonds>(std::move(bonds)),
                                           std::move(potential), std::move(never_fails),
                                           std::move(shares), threads));
}

}  // namespace peristat
