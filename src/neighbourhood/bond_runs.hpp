#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Bonds of consecutive points to partners that are as many points ahead.
struct BondRun {
  Index first;   ///< of the lower points
  Index points;  ///< how many
  Index ahead;   ///< from a point to its partner
  Index place;   ///< of the first bond among those of its point
  /// Numbers of the bonds' kinds, padded by a batch; null: all are of the first one's kind.
  const std::uint16_t* kinds = nullptr;

  [[nodiscard]] Index last() const { return first + points; }  ///< not part of it
  [[nodiscard]] Offset first_bond(const Bonds& bonds) const { return bonds.offset[first] + place; }
};

/// Bonds of a point, one after another, that are in no run.
struct LooseBonds {
  Index point;
  Offset first, last;  ///< the last one is not part of them
};

/// The bonds of consecutive lower points. On a lattice most of them are in runs: along its rows,
/// wherever holes, cracks and surfaces end them.
class BondRuns {
 public:
  /// Most points of a group: their vectors stay in the nearest cache.
  static constexpr Index longest = 128;
  /// Fewest points that make a run of bonds of one kind, and of several. Fewer take longer than
  /// bond by bond, for example in a cloud of points, where runs are by chance.
  static constexpr Index shortest = 4, shortest_of_several = 12;
  /// Sums go bond by bond where a smaller share of the bonds is in runs: gathering points for runs
  /// would take longer than these save.
  static constexpr double least_share = 0.5;

  /// Consecutive points that are bonded one to the next, with all of their bonds.
  struct Group {
    Index first, last;
    std::span<const BondRun> runs;  ///< ascending by `ahead`, then by their points
    std::span<const LooseBonds> loose;
  };

  BondRuns() = default;
  BondRuns(BondRuns&&) = default;  // not copied: runs point to kinds_
  BondRuns& operator=(BondRuns&&) = default;
  /// Finds the runs of the points first .. last - 1. Bonds to ghosts and images are in
  /// none: their numbers are far.
  /// @param kinds of the bonds. Where they are not numbered, runs end where they change
  BondRuns(const Points& points, const Bonds& bonds, const BondKinds& kinds, Index first,
           Index last);

  [[nodiscard]] std::span<const BondRun> runs() const { return runs_; }
  /// Number of bonds that are in runs.
  [[nodiscard]] Offset bonds_in_runs() const;
  [[nodiscard]] std::size_t groups() const { return ends_.size(); }
  [[nodiscard]] Group group(std::size_t number) const;

  /// Calls on_run(run's number, point, bond) for the bonds of a group that are in runs, and
  /// on_loose(point, bond) for the others, point by point in their order.
  template <class OnRun, class OnLoose>
  static void for_each_bond(const Group& group, const Bonds& bonds, const OnRun& on_run,
                            const OnLoose& on_loose);

 private:
  struct End {
    Index last;
    std::size_t runs, loose;
  };
  void add_group(const Points& points, const Bonds& bonds, const BondKinds& kinds, Index first,
                 Index last);

  Index first_ = 0;
  std::vector<End> ends_;  // of the groups
  std::vector<BondRun> runs_;
  std::vector<LooseBonds> loose_;
  std::vector<std::vector<std::uint16_t>> kinds_;  // of groups that have bonds of several kinds
};

template <class OnRun, class OnLoose>
void BondRuns::for_each_bond(const Group& group, const Bonds& bonds, const OnRun& on_run,
                             const OnLoose& on_loose) {
  for (Index i = group.first; i < group.last; ++i) {
    auto run = group.runs.begin();
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index ahead = bonds.partner(i, bond) - i;
      while (run != group.runs.end() &&
             (run->ahead < ahead || (run->ahead == ahead && run->last() <= i))) {
        ++run;
      }
      const bool inside = run != group.runs.end() && run->ahead == ahead && run->first <= i;
      if (inside) {
        on_run(std::size_t(run - group.runs.begin()), i, bond);
      } else {
        on_loose(i, bond);
      }
    }
  }
}

/// Share of the bonds that are in runs, from 0 to 1.
[[nodiscard]] double share_in_runs(const Points& points, const Bonds& bonds, int threads);

}  // namespace peristat
