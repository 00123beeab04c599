#include "assembly/terms/failure/bond_failure.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "src/core/lanes.hpp"
#include "src/geometry/counts_bond.hpp"
#include "src/potentials/critical_of_work.hpp"

namespace peristat {
namespace {

/// Calls visit(point, bond) for every bond.
template <class Visit>
void for_each_bond(const Bonds& bonds, const Visit& visit) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) visit(i, bond);
  }
}

}  // namespace

void BondFailure::require_length(std::span<const double> history) const {
  if (history.size() != (onsets_ ? 3 : 1) * padded()) {
    throw std::logic_error("bonds that can be damaged are evaluated after their history");
  }
}

std::vector<double> BondFailure::history_of(std::span<const double> largest_stretches,
                                            std::span<const double> before) const {
  if (largest_stretches.size() != std::size_t(bonds().count())) {
    throw std::logic_error("a history has a stretch for every bond");
  }
  require_length(before);
  std::vector<double> history(before.begin(), before.end());
  std::copy(largest_stretches.begin(), largest_stretches.end(), history.begin());
  return history;
}

void BondFailure::renew_onsets(const Points& points,
                               std::span<const StrengthOnsets::PointOnset> of_points,
                               std::span<double> history) const {
  require_length(history);
  const std::span<double> onsets = history.subspan(padded()),
                          criticals = history.subspan(2 * padded());
  std::visit(
      [&]<class P>(const P& law) {
        if constexpr (requires { law.laws; }) {
          for_each_bond(bonds(), [&](Index i, Offset bond) {
            const auto b = std::size_t(bond);
            if (history[b] != 0.0) return;  // it has started, or never fails
            const AnyBondLaw own = law.laws->at(bond);
            const double onset = own.onset(), work = own.work(Harmonic{1.0}, own.critical());
            const double most = own.largest_onset(work) / onset;
            const auto of = [&](Index point) {
              return of_points[std::size_t(points.source(point))].of_bond(onset, most);
            };
            onsets[b] = 0.5 * (of(i) + of(bonds().partner(i, bond)));
            criticals[b] = critical_of_work(own, onsets[b], work, criticals[b]);
          });
        }
      },
      potential_);
}

double BondFailure::dissipated_energy(std::span<const double> history, const Points* points) const {
  double sum = 0.0;
  with_damage_law(history, [&](const auto& law) {
    for_each_bond(bonds(), [&](Index i, Offset bond) {
      if (points != nullptr && !counts_bond(*points, i, bonds().partner(i, bond))) return;
      sum +=
          bonds().weight(bond) * bonds().length(bond) * law.of_bond(bond).dissipated(history[bond]);
    });
  });
  return sum;
}

double BondFailure::bytes() const {
  return std::visit(
      []<class P>(const P& law) {
        if constexpr (PotentialWithHistory<P>) return law.bytes();
        return 0.0;
      },
      potential_);
}

std::vector<double> BondFailure::initial_history() const {
  if (!can_fail()) return {};
  std::vector<double> history((onsets_ ? 3 : 1) * padded(), 0.0);
  for (std::size_t bond = 0; bond < never_fails_.size(); ++bond) {
    if (never_fails_[bond]) history[bond] = never_failing;
  }
  std::visit(
      [&]<class P>(const P& law) {
        if constexpr (requires { law.laws; }) {
          for (std::size_t bond = 0; onsets_ && bond < padded(); ++bond) {
            const AnyBondLaw own = law.laws->at(Offset(bond));
            history[padded() + bond] = own.onset();
            history[2 * padded() + bond] = own.critical();
          }
        }
      },
      potential_);
  return history;
}

std::vector<char> BondFailure::broken(const Bonds& all, std::span<const double> history) const {
  std::vector<char> broken;
  with_damage_law(history, [&](const auto& law) {
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
    for (const Index point : {i, all.partner(i, bond)}) {
      whole[point] += weight;
      left[point] += integrity * weight;
    }
  };
  BondLosses lost{.dissipated_energy = dissipated_energy(history, points)};
  if (!can_fail()) for_each_bond(all, [&](Index i, Offset bond) { add(i, bond, 1.0); });
  with_damage_law(history, [&](const auto& law) {
    for_each_bond(all, [&](Index i, Offset bond) {
      const bool counts = points == nullptr || counts_bond(*points, i, all.partner(i, bond));
      add(i, bond, law.of_bond(bond).integrity_after(history[bond]));
      lost.broken_bonds +=
          counts && law.of_bond(bond).is_broken(history[bond]) && all.weight(bond) != 0.0;
    });
  });
  return lost;
}

}  // namespace peristat
