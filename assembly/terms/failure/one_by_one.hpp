#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "assembly/energy/evaluation.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// A bond that is driven beyond what it bears.
struct DrivenBond {
  double utilisation = 0.0;
  Index point = 0;  ///< its first
  Offset bond = 0;
  double stretch = 0.0;  ///< s
  Offset twin = -1;      ///< another bond that is damaged with it
  [[nodiscard]] int bonds() const { return twin < 0 ? 1 : 2; }
};

/// Relative growth of a history below which it counts as none: solving and damaging in turns would
/// never end otherwise.
inline constexpr double least_growth = 1e-9;

/// Adds what an equivalent stretch would do to a bond, and calls visit(bond) if it would damage it
/// noticeably.
template <class OfBond, class Visit>
void judge_driven(const OfBond& of_bond, DrivenBond bond, double driving, double history,
                  DamageGrowth& growth, const Visit& visit) {
  bond.utilisation = of_bond.utilisation(driving, history);
  growth.utilisation = std::max(growth.utilisation, bond.utilisation);
  const bool grows =
      of_bond.is_loading(driving, history) && driving > history * (1.0 + least_growth);
  if (!grows) return;
  growth.degrading += bond.bonds();
  growth.breaking += of_bond.is_broken(driving) ? bond.bonds() : 0;
  visit(bond);
}

/// Moves the history of a bond to an equivalent stretch. Returns the integrity that it loses;
/// nothing if the stretch does not drive it (any more).
template <class OfBond>
[[nodiscard]] std::optional<double> damage_driven(const OfBond& of_bond, double driving,
                                                  double& history) {
  // The digits that rounding of another order takes must not keep a bond from its damage.
  if (!of_bond.is_loading(driving, history)) driving *= 1.0 + 0.5 * least_growth;
  if (!of_bond.is_loading(driving, history)) return std::nullopt;
  const double before = of_bond.integrity_after(history);
  history = driving;
  return before - of_bond.integrity_after(history);
}

/// Driven bonds, the most utilised first, of equal ones the first.
/// @param find(visit) calls visit(part, bond) for each of them
template <class Find>
[[nodiscard]] std::vector<DrivenBond> driven_in_order(int parts, const Find& find) {
  std::vector<std::vector<DrivenBond>> of_part(static_cast<std::size_t>(parts));
  find([&](int part, const DrivenBond& bond) { of_part[std::size_t(part)].push_back(bond); });
  std::vector<DrivenBond> driven;
  for (const auto& some : of_part) driven.insert(driven.end(), some.begin(), some.end());
  std::ranges::sort(driven, [](const DrivenBond& a, const DrivenBond& b) {
    return a.utilisation != b.utilisation ? a.utilisation > b.utilisation : a.bond < b.bond;
  });
  return driven;
}

/// Damages bonds by release until none is driven: one after another, the most utilised first, each
/// as those before it have left the body. Bonds share what they would set free, and all at once
/// would count it more than once.
/// @param find see driven_in_order
/// @param damage(bond, growth) damages it if it still is driven, and counts it
template <class Find, class Damage>
DamageGrowth damage_one_by_one(int parts, const Find& find, const Damage& damage) {
  DamageGrowth growth;
  for (;;) {
    const Index before = growth.degrading;
    for (const DrivenBond& one : driven_in_order(parts, find)) damage(one, growth);
    if (growth.degrading == before) return growth;  // none, or round-off alone has driven them
  }
}

}  // namespace peristat
