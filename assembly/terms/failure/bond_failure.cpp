#include "assembly/terms/failure/bond_failure.hpp"

#include <algorithm>
#include <stdexcept>

#include "src/core/lanes.hpp"
#include "src/geometry/counts_bond.hpp"

namespace peristat {
namespace {

/// Length of the bonds' history, padded since kernels read whole batches of lanes.
std::size_t padded(const Bonds& bonds) { return std::size_t(bonds.count()) + lane_count; }

/// Calls visit(point, bond) for every bond.
template <class Visit>
void for_each_bond(const Bonds& bonds, const Visit& visit) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) visit(i, bond);
  }
}

}  // namespace

std::vector<double> BondFailure::history_of(std::span<const double> largest_stretches) const {
  if (largest_stretches.size() != std::size_t(bonds().count())) {
    throw std::logic_error("a history has a stretch for every bond");
  }
  std::vector<double> history(padded(bonds()), 0.0);
  std::copy(largest_stretches.begin(), largest_stretches.end(), history.begin());
  return history;
}

double BondFailure::dissipated_energy(std::span<const double> history, const Points* points) const {
  double sum = 0.0;
  with_damage_law([&](const auto& law) {
    for_each_bond(bonds(), [&](Index i, Offset bond) {
      if (points != nullptr && !counts_bond(*points, i, bonds().partner[bond])) return;
      sum +=
          bonds().weight(bond) * bonds().length(bond) * law.of_bond(bond).dissipated(history[bond]);
    });
  });
  return sum;
}

double BondFailure::bytes() const {
  double bytes = 0.0;
  with_damage_law([&](const auto& law) { bytes = law.bytes(); });
  return bytes;
}

std::vector<double> BondFailure::initial_history() const {
  std::vector<double> history;
  with_damage_law([&]<class P>(const P&) {
    history.assign(padded(bonds()), 0.0);
    for (std::size_t bond = 0; bond < never_fails_.size(); ++bond) {
      if (never_fails_[bond]) history[bond] = P::never_fails;
    }
  });
  return history;
}

std::vector<char> BondFailure::broken(const Bonds& all, std::span<const double> history) const {
  std::vector<char> broken;
  with_damage_law([&](const auto& law) {
    broken.resize(std::size_t(all.count()));
    for (std::size_t bond = 0; bond < broken.size(); ++bond) {
      broken[bond] = law.of_bond(Offset(bond)).is_broken(history[bond]);
    }
  });
  return broken;
}

BondLosses BondFailure::weigh(std::span<const double> history, const Points* points,
                              std::span<double> whole, std::span<double> left) const {
  const Bonds& all = bonds();
  const auto add = [&](Index i, Offset bond, double integrity) {
    const double weight = all.weight(bond);
    for (const Index point : {i, all.partner[bond]}) {
      whole[point] += weight;
      left[point] += integrity * weight;
    }
  };
  BondLosses lost{.dissipated_energy = dissipated_energy(history, points)};
  if (!can_fail()) for_each_bond(all, [&](Index i, Offset bond) { add(i, bond, 1.0); });
  with_damage_law([&](const auto& law) {
    for_each_bond(all, [&](Index i, Offset bond) {
      const bool counts = points == nullptr || counts_bond(*points, i, all.partner[bond]);
      add(i, bond, law.of_bond(bond).integrity_after(history[bond]));
      lost.broken_bonds +=
          counts && law.of_bond(bond).is_broken(history[bond]) && all.weight(bond) != 0.0;
    });
  });
  return lost;
}

}  // namespace peristat
