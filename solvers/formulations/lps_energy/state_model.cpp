#include "solvers/formulations/lps_energy/state_model.hpp"

#include <memory>
#include <utility>

#include "assembly/terms/states/state_term.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"

namespace peristat {
BondSetting state_setting(BondSetting setting) {
  if (!setting.influence) {
    setting.influence = [](double x) { return x; };
    return setting;
  }
  setting.influence = [kernel = std::move(setting.influence)](double x) { return x * kernel(x); };
  return setting;
}

MadeModel make_state_model(const ModelSetting& setting, Bonds bonds) {
  const BodySpecification& from = setting.of;
  const Points& points = setting.points;
  const BondSetting of_states = state_setting(setting.bonds);
  std::vector<DirectedConstant> moduli;
  for (const auto& material : all_materials(from, setting.materials)) {
    const LamePair constants = lame_constants(*material.of, points.dimension);
    moduli.push_back(
        {{modulus_of_crack(crack_energy_of_dilation(constants, of_states), of_states), 0.0, 0.0},
         {}});
  }
  StateShares shares;
  shares.constants = constants_of_points(setting);
  shares.moment = moments_of(points, bonds, kernel_of_weights(bonds));
  const BondMaterials mixed(from, setting.materials, setting.factors, points, std::move(moduli));
  if (!from.is_uniform()) {
    // The kernel of the states does not depend on materials; the energy that bonds dissipate does.
    refuse_idle_interfaces(from, setting.materials, bonds, setting.index_map.ranks());
    Bonds plain = bonds;
    static_cast<void>(cut_bonds(plain, points, from.cracks));
    shares.kernel = kernel_of_weights(plain);
    mixed.weigh(bonds);
  }
  CutBonds cut = cut_bonds(bonds, points, from.cracks);
  if (from.is_uniform()) shares.kernel = kernel_of_weights(bonds);
  auto [potential, never_fails] = mixed.potential(bonds);
  return {Model(std::make_shared<StateTerm>(std::make_shared<const Bonds>(std::move(bonds)),
                                            std::move(potential), std::move(never_fails),
                                            std::move(shares), setting.threads)),
          std::move(cut)};
}

}  // namespace peristat
