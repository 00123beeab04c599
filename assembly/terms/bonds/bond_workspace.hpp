#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "assembly/terms/bonds/point_columns.hpp"
#include "assembly/terms/bonds/run_pieces.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/core/aligned_vector.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Doubles per gathered row: two vectors, each padded to the width of a transposition where one
/// does not hold both.
constexpr int row_width(int dimension) { return dimension == 3 ? 8 : 4; }

/// Columns of the points that a thread's runs reach at the moment: a window that moves with them,
/// so that large bodies need no second copy of their vectors and sums.
struct RunWindow {
  RunWindow(int dimension, Index most)
      : vectors(2 * dimension, most), sums(dimension, most), capacity(most) {}

  PointColumns vectors;  ///< the packed ones, components of the first one first
  PointColumns sums;
  Index capacity;
  Index first = 0, last = 0;
};

/// Buffers of the passes over bonds.
struct BondWorkspace {
  /// @param along_runs also sums along runs of points with alike bonds
  BondWorkspace(const Points& of, const Bonds& with, Workspace& shared, bool along_runs = false)
      : points(of),
        bonds(with),
        threads(shared),
        rows(std::size_t(of.count()) * row_width(of.dimension)),
        runs(along_runs ? bond_runs(of, with, shared.threads()) : std::vector<BondRun>()) {
    if (runs.empty()) return;
    reach = runs.reach(with);
    for (const RowRange& range : shared.ranges) {
      windows.emplace_back(of.dimension, std::min(range.touched_end - range.first,
                                                  2 * (reach + RunPieces::longest)));
    }
  }

  const Points& points;
  const Bonds& bonds;
  Workspace& threads;
  AlignedVector<double> rows;  ///< per point, the row that kernels gather; see pack
  RunPieces runs;
  Index reach = 0;                 ///< points to the farthest partner of a run's point
  std::vector<RunWindow> windows;  ///< of each thread

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

  /// Sums a thread's rows: pieces of runs by on_piece(piece, window), which reads and adds to the
  /// window's columns, the other rows by on_rows(first, last, sums).
  /// @param sums `width` doubles per row, which everything is added to
  template <int D, int width, class OnPiece, class OnRows>
  void sum_range(int thread, RowRange range, double* sums, const OnPiece& on_piece,
                 const OnRows& on_rows) {
    if (runs.empty()) return on_rows(range.first, range.last, sums);
    RunWindow& window = windows[std::size_t(thread)];
    window.first = window.last = range.first;
    runs.for_each(
        range,
        [&](const RunPiece& piece) {
          if (std::min(piece.last + reach, range.touched_end) > window.last) {
            add_sums<D, width>(window, sums);
            move<D>(window, piece.first, range.touched_end);
          }
          on_piece(piece, window);
        },
        [&](Index first, Index last) { on_rows(first, last, sums); });
    add_sums<D, width>(window, sums);
  }

 private:
  template <int D, int width>
  static void add_sums(const RunWindow& window, double* sums) {
    for (Index i = window.first; i < window.last; ++i) {
      for (int c = 0; c < D; ++c) sums[std::ptrdiff_t(i) * width + c] += window.sums[c][i];
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
