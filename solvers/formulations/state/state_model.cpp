#include "solvers/formulations/state/state_model.hpp"

#include <memory>
#include <utility>

#include "solvers/formulations/solid/solid_constants.hpp"
#include "solvers/formulations/specification/require.hpp"
#include "src/materials/bulk_bonds.hpp"
#include "src/materials/bulk_pull.hpp"
#include "src/materials/quadrature.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
BondSetting state_setting(BondSetting setting) {
  if (!setting.influence) {
    setting.influence = [](double x) { return x; };
    return setting;
  }
  setting.influence = [kernel = std::move(setting.influence)](double x) { return x * kernel(x); };
  return setting;
}

double micromodulus_of_states(const MaterialSpecification& material, const BondSetting& setting) {
  const int d = setting.dimension;
  const BondSetting of_states = state_setting(setting);
  const double moment = of_states.lattice ? BulkBonds(of_states).moment(1) : of_states.moment(1);
  return 2.0 * d * (d + 2) * lame_constants(material, d).mu / moment;
}

namespace {

/// lambda / mu from which dilatations, spread over the horizon, drive the bonds at a crack tip
/// late, and up to which they may.
constexpr double late_ratio = 2.5, most_ratio = 4.0;

double lame_ratio(const MaterialSpecification& material, int dimension) {
  const LamePair constants = lame_constants(material, dimension);
  return constants.lambda / constants.mu;
}

/// Refuses images of parts of a body: a part lacks some twins of its bonds.
void refuse_images_of_parts(const ModelSetting& setting) {
  require(setting.index_map.is_whole() || setting.points.images.kinds.empty(), "material.model",
          "state", "is for one rank with planes of symmetry and periods");
}

/// Weights with which bonds take kappa r^2 (q_i + q_j) times the work of their law, q = V d (d + 2)
/// mu / M, by a potential of this modulus.
void weigh_by_release(Bonds& bonds, const Points& points, const StateShares& shares,
                      double modulus) {
  const int d = points.dimension;
  const auto q = [&](Index point) {
    const auto i = std::size_t(point);
    return points.volume[i] * d * (d + 2) * shares.constants[i].mu / shares.moment[i];
  };
  bonds.set_weights([&](Index i, Offset bond) {
    return shares.whole[bond].weight * (q(i) + q(bonds.partner(i, bond))) / modulus;
  });
}

}  // namespace

void check_release_of_states(const MaterialSpecification& material, const std::string& key,
                             int dimension) {
  require(lame_ratio(material, dimension) <= most_ratio * (1.0 + 1e-9), key + ".poisson_ratio",
          number_text(*material.poisson_ratio),
          "is too near 1/2 for damage by release of states: cracks would run far above their "
          "fracture energy; take at most 0.4");
}

std::string warning_of_late_cracks(const MaterialSpecification& material, const std::string& key,
                                   const BondSetting& setting) {
  const double ratio = lame_ratio(material, setting.dimension);
  if (ratio <= late_ratio) return "";
  return key + ".poisson_ratio = " + number_text(*material.poisson_ratio) +
         ": a crack of model \"" + (material.model == MaterialModel::lps ? "lps" : "state") +
         "\" needs more than the fracture energy to run where lambda/mu is above " +
         number_text(late_ratio) + "; here it is " + number_text(ratio) +
         ". At 4, in plane strain, a steady crack takes 1.07 times as much";
}

FractureScale scale_of_states(const MaterialSpecification& material, const std::string&,
                              const BondSetting& setting, double spacing) {
  BondSetting of_states = state_setting(setting);
  // Every point divides by its own weighted volume, so that m_1 is right in a cloud, too.
  if (of_states.cloud) of_states.cloud->surface_correction = SurfaceCorrection::energy;
  FractureScale scale;
  scale.spacing = spacing;
  scale.micromodulus = micromodulus_of_states(material, setting);
  scale.crossing = mean_crossing(of_states);
  scale.youngs_modulus = *material.youngs_modulus;
  scale.pull = std::make_shared<BulkPull>(of_states, scale.micromodulus,
                                          lame_ratio(material, setting.dimension));
  return scale;
}

MadeModel make_state_model(const ModelSetting& setting, Bonds bonds, StateRules rules) {
  const BodySpecification& from = setting.of;
  const Points& points = setting.points;
  const bool is_by_release = rules.drive == DamageDrive::release;
  refuse_images_of_parts(setting);
  if (points.own() < points.count()) drop_weightless(bonds);
  const BondSetting of_states = state_setting(setting.bonds);
  std::vector<DirectedConstant> moduli;
  for (const auto& material : all_materials(from, setting.materials)) {
    const double modulus =
        is_by_release
            ? micromodulus_of_states(*material.of, setting.bonds)
            : modulus_of_crack(crack_energy_of_dilation(
                                   lame_constants(*material.of, points.dimension), of_states),
                               of_states);
    moduli.push_back({{modulus, 0.0, 0.0}, {}});
  }
  StateShares shares;
  shares.constants = constants_of_points(setting);
  shares.moment = moments_of(points, bonds);
  const BondMaterials mixed(from, setting.materials, setting.factors, points, std::move(moduli));
  if (!from.is_uniform()) {
    // The kernel of the states does not depend on materials; the energy that bonds dissipate does.
    refuse_idle_interfaces(from, setting.materials, bonds, setting.index_map.ranks());
    Bonds plain = bonds;
    static_cast<void>(cut_bonds(plain, points, from.cracks));
    shares.whole = std::move(plain.kind);
    mixed.weigh(bonds);
  }
  CutBonds cut = cut_bonds(bonds, points, from.cracks);
  if (from.is_uniform()) shares.whole = bonds.kind;
  shares.twins = twins_of(points, bonds);
  if (is_by_release) weigh_by_release(bonds, points, shares, mixed.modulus());
  auto [potential, never_fails] = mixed.potential(bonds);
  return {Model(std::make_shared<StateTerm>(std::make_shared<const Bonds>(std::move(bonds)),
                                            std::move(potential), std::move(never_fails),
                                            std::move(shares), rules, setting.threads)),
          std::move(cut)};
}

}  // namespace peristat
