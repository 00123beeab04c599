#include "assembly/terms/damage.hpp"

#include <algorithm>

#include "src/geometry/gather_images.hpp"

namespace peristat {
DamageState assess_damage(const Model& model, const History& history,
                          std::span<const double> cut_weight, std::span<double> damage,
                          const Points* points) {
  std::ranges::fill(damage, 0.0);
  const FailureModel& failure = model.failure();
  if (!failure.can_fail() && cut_weight.empty()) return {};
  std::vector<double> whole(cut_weight.begin(), cut_weight.end()), left(damage.size(), 0.0);
  whole.resize(damage.size(), 0.0);
  const BondLosses lost = failure.weigh(model.failure_history(history), points, whole, left);
  if (points != nullptr) {
    for (std::vector<double>* sums : {&whole, &left}) gather_images(*points, *sums);
  }
  // On a part of a body the damage of the points that its rank owns, the first ones, is told.
  const bool is_part = points != nullptr && points->owned;
  const std::size_t told = is_part ? std::size_t(*points->owned) : damage.size();
  DamageState state{lost.dissipated_energy, lost.broken_bonds};
  for (std::size_t i = 0; i < damage.size(); ++i) {
    if (!(whole[i] > 0.0)) continue;
    const double of_point = 1.0 - left[i] / whole[i];
    if (!(of_point <= lost.round_off)) damage[i] = std::min(of_point, 1.0);  // a NaN stays visible
    if (i < told) state.max_damage = std::max(state.max_damage, damage[i]);
  }
  return state;
}

std::span<const double> bond_stretches(const Model& model, const History& history) {
  if (!model.failing_bonds()) return {};
  return model.failure_history(history).first(std::size_t(model.bonds().count()));
}

std::vector<char> broken_bonds(const Model& model, const History& history) {
  return model.failure().broken(model.bonds(), model.failure_history(history));
}

std::shared_ptr<const Bonds> whole_network(const Model& model) {
  return model.failure().whole_network();
}

DamagedNetwork damaged_network(const Model& model, const History& history) {
  const std::shared_ptr<const Bonds> bonds = whole_network(model);
  return {bonds, model.failure().broken(*bonds, model.failure_history(history))};
}

}  // namespace peristat
