#include "assembly/terms/struts.hpp"

#include <algorithm>
#include <functional>

#include "assembly/terms/bonds/bond_look.hpp"
#include "src/core/threads.hpp"

namespace peristat {
namespace {

/// Share of the ways round a strut that are cut, and the elongation of their broken bonds over the
/// one that the strut bears. Bonds ahead of a crack's tip have smaller ones. At half of this
/// opening a steady crack would need 5 % less energy; at this one it is within 0.3 % of that of
/// bonds that fail by their stretch alone (docs/trustworthy-peaks.md).
constexpr double least_share = 0.6, least_opening = 2.0;
constexpr int least_ways = 3;

/// Broken bonds, and the points that have some.
struct Broken {
  std::vector<char> bond, point;
  bool any = false;
};

Broken broken_of(const BondFailure& failure, const Bonds& bonds, std::span<const double> history) {
  Broken broken;
  failure.with_damage_law(history, [&](const auto& law) {
    for (Index i = 0; i < bonds.points(); ++i) {
      for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
        const double largest = history[std::size_t(bond)];
        if (!(largest > 0.0) || !law.of_bond(bond).is_broken(largest)) continue;
        if (!broken.any) {
          broken.bond.resize(std::size_t(bonds.count()));
          broken.point.resize(std::size_t(bonds.points()));
        }
        broken.any = true;
        broken.bond[std::size_t(bond)] = broken.point[std::size_t(i)] =
            broken.point[std::size_t(bonds.partner(i, bond))] = 1;
      }
    }
  });
  return broken;
}

/// Ways round a bond.
struct Ways {
  int cut = 0, open = 0;
  double elongation = 0.0;  ///< sum over the cut ones [m]
  void operator+=(const Ways& other) {
    cut += other.cut;
    open += other.open;
    elongation += other.elongation;
  }
  /// @param borne elongation at which the bond breaks [m]
  [[nodiscard]] bool leave_a_strut(double borne) const {
    return cut + open >= least_ways && cut >= least_share * (cut + open) &&
           elongation >= least_opening * borne * cut;
  }
};

constexpr Offset none = -1;

/// Visits the ways round bonds of one point after another.
template <int D>
class WaysRound {
 public:
  WaysRound(const Bonds& bonds, const LowerNeighbours& below, const Broken& broken,
            const BondLook<D>& look)
      : bonds_(bonds),
        below_(below),
        broken_(broken),
        look_(look),
        bond_to_(std::size_t(bonds.points()), none) {}

  /// The bond between the two points.
  [[nodiscard]] Ways of(Index i, Index j) {
    begin_at(i);
    Ways ways;
    below_.for_each_neighbour(bonds_, j, [&](Index p, Offset other) {
      const Offset one = bond_to_[std::size_t(p)];
      if (one == none || bonds_.weight(one) == 0.0 || bonds_.weight(other) == 0.0) return;
      const bool one_is = broken_.bond[std::size_t(one)],
                 other_is = broken_.bond[std::size_t(other)];
      ways.open += !one_is && !other_is;
      if (one_is == other_is) return;
      ++ways.cut;
      ways.elongation +=
          one_is ? elongation(std::min(i, p), one) : elongation(std::min(j, p), other);
    });
    return ways;
  }

 private:
  void begin_at(Index i) {
    if (i == at_) return;
    const auto mark = [&](Index point, bool is_near) {
      below_.for_each_neighbour(bonds_, point, [&](Index p, Offset bond) {
        bond_to_[std::size_t(p)] = is_near ? bond : none;
      });
    };
    if (at_ >= 0) mark(at_, false);
    mark(i, true);
    at_ = i;
  }
  [[nodiscard]] double elongation(Index lower, Offset bond) const {
    return look_.stretch(lower, bond) * bonds_.length(bond);
  }

  const Bonds& bonds_;
  const LowerNeighbours& below_;
  const Broken& broken_;
  const BondLook<D>& look_;
  std::vector<Offset> bond_to_;  // from the point at_, per point
  Index at_ = -1;
};

/// True for a bond that is there and can fail.
bool may_fail(const Bonds& bonds, Offset bond, const Broken& broken,
              std::span<const double> history) {
  const auto b = std::size_t(bond);
  return !broken.bond[b] && history[b] != never_failing && bonds.weight(bond) != 0.0;
}

std::function<double(Offset)> critical_stretches(const BondFailure& failure,
                                                 std::span<const double> history) {
  std::function<double(Offset)> critical;
  failure.with_damage_law(history, [&](const auto& law) {
    critical = [law](Offset bond) { return law.of_bond(bond).law.critical(); };
  });
  return critical;
}

Index lower_end(const Bonds& bonds, Offset bond) {
  return Index(std::ranges::upper_bound(bonds.offset, bond) - bonds.offset.begin()) - 1;
}

}  // namespace

template <int D>
std::vector<Offset> Struts::find_in(const BondFailure& failure, const Points& points,
                                    const StateView& at, std::span<const double> history,
                                    int threads) const {
  const Broken broken = broken_of(failure, bonds_, history);
  if (!broken.any) return {};
  const std::function<double(Offset)> critical = critical_stretches(failure, history);
  const BondLook<D> look(points, bonds_, at);
  std::vector<std::vector<Offset>> of_thread(static_cast<std::size_t>(threads));
  run_on_threads(threads, [&](int thread) {
    WaysRound<D> round(bonds_, below_, broken, look);
    const auto is_strut = [&](Index i, Offset bond) {
      Ways ways;
      // Halves of a bond across a plane have the ways on either side; a bond between two images has
      // no weight, and is not surrounded by all of its neighbours.
      alike_.for_each(bond, [&](Offset one) {
        if (bonds_.weight(one) == 0.0) return;
        const Index lower = one == bond ? i : lower_end(bonds_, one);
        ways += round.of(lower, bonds_.partner(lower, one));
      });
      return ways.leave_a_strut(critical(bond) * bonds_.length(bond));
    };
    std::vector<Offset>& found = of_thread[std::size_t(thread)];
#pragma omp for schedule(static) nowait
    for (Index i = 0; i < bonds_.points(); ++i) {
      for (Offset bond = bonds_.offset[i]; bond < bonds_.offset[i + 1]; ++bond) {
        if (!broken.point[std::size_t(i)] && !broken.point[std::size_t(bonds_.partner(i, bond))])
          continue;
        if (alike_.first(bond) != bond || !may_fail(bonds_, bond, broken, history)) continue;
        if (is_strut(i, bond)) alike_.for_each(bond, [&](Offset one) { found.push_back(one); });
      }
    }
  });
  std::vector<Offset> all;
  for (const auto& some : of_thread) all.insert(all.end(), some.begin(), some.end());
  std::ranges::sort(all);
  return all;
}

std::vector<Offset> Struts::find(const BondFailure& failure, const Points& points,
                                 const StateView& at, std::span<const double> history,
                                 int threads) const {
  switch (points.dimension) {
    case 1:
      return find_in<1>(failure, points, at, history, threads);
    case 2:
      return find_in<2>(failure, points, at, history, threads);
    default:
      return find_in<3>(failure, points, at, history, threads);
  }
}

}  // namespace peristat
