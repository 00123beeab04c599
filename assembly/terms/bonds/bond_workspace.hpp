#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "assembly/terms/bonds/thread_runs.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/core/aligned_vector.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Doubles per gathered row: two vectors, each padded to the width of a transposition where one
/// does not hold both.
constexpr int row_width(int dimension) { return dimension == 3 ? 8 : 4; }

/// Buffers of the passes over bonds.
struct BondWorkspace {
  /// @param kinds of the bonds, whose sums go along runs; null: they go bond by bond
  BondWorkspace(const Points& of, const Bonds& with, Workspace& shared,
                const BondKinds* kinds = nullptr)
      : points(of),
        bonds(with),
        threads(shared),
        rows(std::size_t(of.count()) * row_width(of.dimension)) {
    if (kinds) runs = ThreadRuns(of, with, *kinds, shared.ranges);
  }

  const Points& points;
  const Bonds& bonds;
  Workspace& threads;
  AlignedVector<double> rows;  ///< per point, the row that kernels gather; see pack
  ThreadRuns runs;

  /// Packs two vectors per point into rows, e.g. reference position and displacement.
  template <int D>
  void pack(std::span<const double> first, std::span<const double> second) {
    constexpr int width = row_width(D);
    const Index count = points.count();
#pragma omp parallel for num_threads(threads.threads())
    for (Index i = 0; i < count; ++i) {
      double* row = &rows[std::size_t(i) * width];
      for (int c = 0; c < D; ++c) {
        row[c] = first[std::size_t(i) * D + c];
        row[width / 2 + c] = second[std::size_t(i) * D + c];
      }
    }
  }

  /// Sums the bonds of a thread's rows: runs by on_run(run, damage, window), which reads and adds
  /// to the window's columns, the other ones by on_loose(bonds of a point, sums).
  /// @tparam columns of the window's sums that are added up
  /// @param sums `width` doubles per row, which everything is added to
  template <int D, int width, int columns = D, class OnRun, class OnLoose>
  void sum_range(int thread, RowRange range, double* sums, const OnRun& on_run,
                 const OnLoose& on_loose) {
    if (!runs.in_use()) {
      for (Index i = range.first; i < range.last; ++i) {
        on_loose(LooseBonds{i, bonds.offset[i], bonds.offset[i + 1]}, sums);
      }
      return;
    }
    ThreadRuns::OfThread& one = runs.of(thread);
    RunWindow& window = one.window;
    window.first = window.last = range.first;
    RunDamage* damage = one.damage.empty() ? nullptr : one.damage.data();
    for (std::size_t g = 0; g < one.bonds.groups(); ++g) {
      const BondRuns::Group group = one.bonds.group(g);
      if (std::min(group.last + one.reach, range.touched_end) > window.last) {
        add_sums<columns, width>(window, sums);
        move<D>(window, group.first, range.touched_end);
      }
      for (const BondRun& run : group.runs) on_run(run, damage ? damage++ : nullptr, window);
      for (const LooseBonds& loose : group.loose) on_loose(loose, sums);
    }
    add_sums<columns, width>(window, sums);
  }

 private:
  template <int columns, int width>
  static void add_sums(const RunWindow& window, double* sums) {
    for (Index i = window.first; i < window.last; ++i) {
      for (int c = 0; c < columns; ++c) sums[std::ptrdiff_t(i) * width + c] += window.sums[c][i];
    }
  }

  /// Lets a window start at this point, with the packed vectors and sums of zero.
  template <int D>
  void move(RunWindow& window, Index first, Index end) const {
    constexpr int width = row_width(D);
    window.first = first;
    window.last = std::min(first + window.capacity, end);
    window.vectors.start_at(first);
    window.sums.start_at(first);
    window.sums.clear();
    for (Index i = first; i < window.last; ++i) {
      const double* const row = &rows[std::size_t(i) * width];
      for (int c = 0; c < D; ++c) {
        window.vectors[c][i] = row[c];
        window.vectors[D + c][i] = row[width / 2 + c];
      }
    }
  }
};

}  // namespace peristat
