#include "assembly/terms/damage.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>

#include "assembly/terms/points/point_term.hpp"
#include "src/geometry/counts_bond.hpp"

namespace peristat {
namespace {

/// Calls visit(law) if the bonds can be damaged; law.of_bond(bond) is that of one of them.
template <class Visit>
void with_law(const Model& model, const Visit& visit) {
  if (const BondTerm* const bonds = model.failing_bonds()) bonds->with_damage_law(visit);
}

/// Adds the sums of images to those of their sources, and copies the result back to the images.
void gather_images(std::span<const Index> sources, std::vector<double>& sums) {
  const std::size_t own = sums.size() - sources.size();
  for (std::size_t k = 0; k < sources.size(); ++k) sums[std::size_t(sources[k])] += sums[own + k];
  for (std::size_t k = 0; k < sources.size(); ++k) sums[own + k] = sums[std::size_t(sources[k])];
}

std::span<const Index> sources_of_images(const Points* points) {
  return points != nullptr ? std::span<const Index>(points->images.source)
                           : std::span<const Index>();
}

/// Number of points, the first ones, whose damage enters the maximum: on a part of a body those
/// that its rank owns.
std::size_t told_points(const Points* points, std::span<const double> damage) {
  return points != nullptr && points->owned ? std::size_t(*points->owned) : damage.size();
}

/// Marks the bonds of points that have lost their integrity.
std::vector<char> without_points(const Bonds& bonds, std::span<const double> integrity) {
  std::vector<char> broken(integrity.empty() ? 0 : std::size_t(bonds.count()));
  if (broken.empty()) return broken;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const auto j = std::size_t(bonds.partner[bond]);
      broken[std::size_t(bond)] = integrity[std::size_t(i)] == 0.0 || integrity[j] == 0.0;
    }
  }
  return broken;
}

/// Number of such bonds, as far as a part of a body counts them.
Index count_without_points(const Bonds& bonds, std::span<const double> integrity,
                           const Points& points) {
  const std::vector<char> broken = without_points(bonds, integrity);
  Index count = 0;
  for (Index i = 0; i < bonds.points() && !broken.empty(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      count += broken[std::size_t(bond)] && counts_bond(points, i, bonds.partner[bond]);
    }
  }
  return count;
}

/// Damage of a body whose points lose their integrity, and with it all of their bonds.
DamageState assess_points(const PointTerm& term, std::span<const double> history,
                          std::span<const double> cut_weight, std::span<double> damage,
                          const Points* points) {
  const std::span<const Index> image_sources = sources_of_images(points);
  DamageState state;
  std::ranges::fill(damage, 0.0);
  if (history.empty() && cut_weight.empty()) return state;
  const std::vector<double> whole(damage.size(), 1.0);
  NeighbourSums left = term.neighbours(history.empty() ? whole : history.first(damage.size()));
  state.dissipated_energy = history.empty() ? 0.0 : history.back();
  if (points != nullptr && points->owned) {
    state.broken_bonds = count_without_points(term.bonds(), history, *points);
  } else {
    const double count = 0.5 * std::accumulate(left.count.begin(), left.count.end(), 0.0);
    state.broken_bonds = static_cast<Index>(std::round(double(term.count()) - count));
  }
  std::vector<double> all = term.whole_weight();
  for (std::size_t i = 0; i < cut_weight.size(); ++i) all[i] += cut_weight[i];
  gather_images(image_sources, all);
  gather_images(image_sources, left.weight);
  for (std::size_t i = 0; i < damage.size(); ++i) {
    const double of_point = all[i];
    if (!history.empty() && history[i] == 0.0) {
      damage[i] = 1.0;
    } else if (of_point > 0.0) {
      constexpr double round_off = 1e-12;  // of convolutions
      const double lost = 1.0 - left.weight[i] / of_point;
      damage[i] = lost > round_off ? std::min(lost, 1.0) : 0.0;
    }
    if (i < told_points(points, damage)) state.max_damage = std::max(state.max_damage, damage[i]);
  }
  return state;
}

const PointTerm* failing_points(const Model& model) {
  return dynamic_cast<const PointTerm*>(model.bond_term().get());
}

}  // namespace

DamageState assess_damage(const Model& model, const History& history,
                          std::span<const double> cut_weight, std::span<double> damage,
                          const Points* points) {
  if (const PointTerm* const of_points = failing_points(model)) {
    return assess_points(*of_points, history.of(model.slot_of(*of_points)), cut_weight, damage,
                         points);
  }
  const std::span<const Index> image_sources = sources_of_images(points);
  const Bonds& bonds = model.bonds();
  DamageState state;
  std::vector<double> whole(cut_weight.begin(), cut_weight.end());
  whole.resize(damage.size(), 0.0);
  std::vector<double> left(damage.size(), 0.0);
  const auto add = [&](Index i, Offset bond, double integrity) {
    const double weight = bonds.weight(bond);
    for (const Index point : {i, bonds.partner[bond]}) {
      whole[point] += weight;
      left[point] += integrity * weight;
    }
  };
  const auto for_each_bond = [&](const auto& integrity) {
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        add(i, bond, integrity(i, bond));
      }
    }
  };
  if (!model.failing_bonds()) for_each_bond([](Index, Offset) { return 1.0; });
  const std::span<const double> stretches = bond_stretches(model, history);
  with_law(model, [&](const auto& laws) {
    for_each_bond([&](Index i, Offset bond) {
      const auto& law = laws.of_bond(bond);
      const double largest = stretches[bond];
      if (points != nullptr && !counts_bond(*points, i, bonds.partner[bond])) {
        return law.integrity_after(largest);
      }
      state.dissipated_energy += bonds.weight(bond) * bonds.length(bond) * law.dissipated(largest);
      state.broken_bonds += law.is_broken(largest) && bonds.weight(bond) != 0.0;
      return law.integrity_after(largest);
    });
  });
  const std::size_t told = told_points(points, damage);
  for (std::vector<double>* sums : {&whole, &left}) gather_images(image_sources, *sums);
  for (std::size_t i = 0; i < damage.size(); ++i) {
    damage[i] = whole[i] > 0.0 ? std::clamp(1.0 - left[i] / whole[i], 0.0, 1.0) : 0.0;
    if (i < told) state.max_damage = std::max(state.max_damage, damage[i]);
  }
  return state;
}

std::span<const double> bond_stretches(const Model& model, const History& history) {
  const BondTerm* const bonds = model.failing_bonds();
  if (!bonds) return {};
  return history.of(model.slot_of(*bonds)).first(std::size_t(bonds->bonds().count()));
}

std::vector<char> broken_bonds(const Model& model, const History& history) {
  if (const PointTerm* const points = failing_points(model)) {
    return without_points(points->bonds(), history.of(model.slot_of(*points)));
  }
  const std::span<const double> stretches = bond_stretches(model, history);
  std::vector<char> broken(stretches.size());
  with_law(model, [&](const auto& law) {
    for (std::size_t bond = 0; bond < broken.size(); ++bond) {
      broken[bond] = law.of_bond(Offset(bond)).is_broken(stretches[bond]);
    }
  });
  return broken;
}

std::shared_ptr<const Bonds> whole_network(const Model& model) {
  const PointTerm* const points = failing_points(model);
  if (points == nullptr || !points->is_convolved()) return model.shared_bonds();
  return std::make_shared<const Bonds>(points->lattice()->all_bonds());
}

DamagedNetwork damaged_network(const Model& model, const History& history) {
  DamagedNetwork network{whole_network(model), {}};
  const PointTerm* const points = failing_points(model);
  if (points == nullptr) return {network.bonds, broken_bonds(model, history)};
  network.broken = without_points(*network.bonds, history.of(model.slot_of(*points)));
  return network;
}

}  // namespace peristat
