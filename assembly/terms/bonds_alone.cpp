#include "assembly/terms/bonds_alone.hpp"

#include <algorithm>
#include <vector>

#include "assembly/terms/failure/one_by_one.hpp"
#include "src/geometry/counts_bond.hpp"

namespace peristat {

namespace {

/// Calls visit(bond) for each bond that would be damaged noticeably. Returns the damage.
template <class Visit>
DamageGrowth visit_driven(const BondFailure& bonds, const Points& points,
                          std::span<const BondDrive> drives, std::span<const double> history,
                          const Visit& visit) {
  const Bonds& network = bonds.bonds();
  DamageGrowth all;
  bonds.with_damage_law(history, [&](const auto& law) {
    for (Index i = 0; i < network.points(); ++i) {
      for (Offset bond = network.offset[i]; bond < network.offset[i + 1]; ++bond) {
        DamageGrowth of_bond;
        judge_driven(law.of_bond(bond), {0.0, i, bond}, drives[std::size_t(bond)].driving(),
                     history[std::size_t(bond)], of_bond,
                     [&](const DrivenBond& one) { visit(one.bond); });
        all.utilisation = std::max(all.utilisation, of_bond.utilisation);
        if (!counts_bond(points, i, network.partner(i, bond))) continue;
        all.degrading += of_bond.degrading;
        all.breaking += of_bond.breaking;
      }
    }
  });
  return all;
}

}  // namespace

DamageGrowth growth_of_bonds_alone(const BondFailure& bonds, const Points& points,
                                   std::span<const BondDrive> drives,
                                   std::span<const double> history) {
  return visit_driven(bonds, points, drives, history, [](Offset) {});
}

DamageGrowth damage_bonds_alone(const BondFailure& bonds, const Points& points,
                                std::span<const BondDrive> drives, std::span<double> history) {
  std::vector<Offset> driven;
  const DamageGrowth found =
      visit_driven(bonds, points, drives, history, [&](Offset bond) { driven.push_back(bond); });
  bonds.with_damage_law(history, [&](const auto& law) {
    for (const Offset bond : driven) {
      const auto b = std::size_t(bond);
      static_cast<void>(damage_driven(law.of_bond(bond), drives[b].driving(), history[b]));
    }
  });
  return {found.degrading, found.breaking};
}

}  // namespace peristat
