#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <omp.h>

#include "assembly/operators/row_ranges.hpp"
#include "assembly/terms/bonds/point_columns.hpp"
#include "assembly/terms/bonds/run_damage.hpp"
#include "src/core/threads.hpp"
#include "src/neighbourhood/bond_runs.hpp"

namespace peristat {

/// Columns of the points that a part's runs reach at the moment: a window that moves with them,
/// so that large bodies need no second copy of their vectors and sums.
struct RunWindow {
  RunWindow() = default;
  RunWindow(int dimension, Index most)
      : vectors(2 * dimension, most), sums(std::max(dimension, 2), most), capacity(most) {}

  PointColumns vectors;  ///< the packed ones, components of the first one first
  PointColumns sums;     ///< of a vector or of two numbers
  Index capacity = 0;
  Index first = 0, last = 0;
};

/// The runs among the bonds of each part's rows, with the damage of a history.
class PartRuns {
 public:
  struct OfPart {
    BondRuns bonds;
    std::vector<RunDamage> damage;  ///< of the runs; empty: no bond can fail
    Index reach = 0;                ///< points from a run's point to its farthest partner
  };

  PartRuns() = default;
  /// @param kinds see BondRuns
  PartRuns(const Points& points, const Bonds& bonds, const BondKinds& kinds,
           const std::vector<RowRange>& ranges, int threads);

  /// True if sums go along runs.
  [[nodiscard]] bool in_use() const { return !of_parts_.empty() && !onsets_move_; }
  [[nodiscard]] OfPart& of(int part) { return of_parts_[std::size_t(part)]; }
  /// The window of the thread that asks.
  [[nodiscard]] RunWindow& window() { return windows_[std::size_t(omp_get_thread_num())]; }

  /// Finds the damaged bonds of a history, unless they are known.
  /// @param law of the bonds at that history
  /// @param version of the history, see History::version
  template <class P>
  void follow(const Bonds& bonds, const P& law, const double* largest_stretch,
              std::uint64_t version);
  /// To be called with the version of a history whose damage the last commit has noted.
  void have_followed(std::uint64_t version) { version_ = version; }

  /// Notes damage anew: calls note(damage of a run, run, number of a bond in it, bond).
  template <class Note>
  void note_damage(const Bonds& bonds, const Note& note);

 private:
  std::vector<OfPart> of_parts_;    // empty: no bond is in a run
  std::vector<RunWindow> windows_;  // per thread
  bool onsets_move_ = false;        // with histories
  bool follows_ = false;            // the history of this version:
  std::uint64_t version_ = 0;
};

template <class P>
void PartRuns::follow(const Bonds& bonds, const P& law, const double* largest_stretch,
                      std::uint64_t version) {
  if constexpr (requires { law.onset; }) onsets_move_ = law.onset != nullptr;
  if (!in_use() || (follows_ && version == version_)) return;
  follows_ = true;
  version_ = version;
  note_damage(bonds, [&](RunDamage& damage, const BondRun& run, Index of, Offset bond) {
    const double onset = law.onset_of(bond), largest = largest_stretch[bond];
    damage.free_below = std::min(damage.free_below, onset);
    // Brittle bonds may be broken at their onset itself.
    if (largest >= onset) damage.note(run, of, bears_nothing(law.of_bond(bond), largest));
  });
}

template <class Note>
void PartRuns::note_damage(const Bonds& bonds, const Note& note) {
  if (of_parts_.empty()) return;
  run_on_parts(int(windows_.size()), int(of_parts_.size()), [&](int part) {
    OfPart& one = of(part);
    one.damage.assign(one.bonds.runs().size(), RunDamage());
    RunDamage* damage = one.damage.data();
    for (std::size_t g = 0; g < one.bonds.groups(); ++g) {
      const BondRuns::Group group = one.bonds.group(g);
      BondRuns::for_each_bond(
          group, bonds,
          [&](std::size_t r, Index i, Offset bond) {
            note(damage[r], group.runs[r], i - group.runs[r].first, bond);
          },
          [](Index, Offset) {});
      damage += group.runs.size();
    }
  });
}

}  // namespace peristat
