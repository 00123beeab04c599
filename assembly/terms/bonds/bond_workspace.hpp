#pragma once

#include <span>

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
    columns = PointColumns(2 * of.dimension, 0, of.count());
    for (const RowRange& range : shared.ranges) {
      column_sums.emplace_back(of.dimension, range.first, range.touched_end);
    }
  }

  const Points& points;
  const Bonds& bonds;
  Workspace& threads;
  AlignedVector<double> rows;  ///< per point, the row that kernels gather; see pack
  RunPieces runs;
  PointColumns columns;                   ///< vectors that runs read; see pack_columns
  std::vector<PointColumns> column_sums;  ///< of each thread, by runs

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

  /// Copies the packed vectors to the columns, the components of the first one first.
  template <int D>
  void pack_columns() {
    if (runs.empty()) return;
    constexpr int width = row_width(D);
    const Index count = points.count();
#pragma omp parallel for num_threads(threads.threads())
    for (Index i = 0; i < count; ++i) {
      const double* const row = &rows[std::size_t(i) * width];
      for (int c = 0; c < D; ++c) {
        columns[c][i] = row[c];
        columns[D + c][i] = row[width / 2 + c];
      }
    }
  }

  /// Sums a thread's rows: pieces of runs by on_piece(piece, columns to add to), the other rows by
  /// on_rows(first, last, sums).
  /// @param sums `width` doubles per row, which everything is added to
  template <int D, int width, class OnPiece, class OnRows>
  void sum_range(int thread, RowRange range, double* sums, const OnPiece& on_piece,
                 const OnRows& on_rows) {
    if (runs.empty()) return on_rows(range.first, range.last, sums);
    PointColumns& of = column_sums[std::size_t(thread)];
    of.clear();
    runs.for_each(
        range, [&](const RunPiece& piece) { on_piece(piece, of); },
        [&](Index first, Index last) { on_rows(first, last, sums); });
    for (Index i = range.first; i < range.touched_end; ++i) {
      for (int c = 0; c < D; ++c) sums[std::ptrdiff_t(i) * width + c] += of[c][i];
    }
  }
};

}  // namespace peristat
