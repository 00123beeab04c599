#pragma once

#include <span>

#include "assembly/energy/history.hpp"
#include "assembly/terms/damage.hpp"
#include "assembly/terms/model.hpp"

namespace peristat {

/// Calls visit(item, 1 - T) for each item whose bond has lost integrity; without a bond, -1, all is
/// lost.
/// @param items of which each has a member `bond`
template <class Items, class Visit>
void for_each_lost_share(const Model& model, const History& history, const Items& items,
                         const Visit& visit) {
  const std::span<const double> stretches = bond_stretches(model, history);
  const BondFailure* const failing = model.failing_bonds();
  if (!failing || stretches.empty()) {
    for (const auto& item : items) {
      if (item.bond < 0) visit(item, 1.0);
    }
    return;
  }
  failing->with_damage_law(model.failure_history(history), [&](const auto& laws) {
    for (const auto& item : items) {
      if (item.bond < 0) {
        visit(item, 1.0);
        continue;
      }
      const double largest = stretches[std::size_t(item.bond)];
      // A bond that has not been damaged has the stretch 0, and one that never fails -1.
      if (largest <= 0.0) continue;
      const double share = 1.0 - laws.of_bond(item.bond).integrity_after(largest);
      if (share > 0.0) visit(item, share);
    }
  });
}

}  // namespace peristat
