#pragma once

#include <span>

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
  BondWorkspace(const Points& of, const Bonds& with, Workspace& shared)
      : points(of),
        bonds(with),
        threads(shared),
        rows(std::size_t(of.count()) * row_width(of.dimension)) {}

  const Points& points;
  const Bonds& bonds;
  Workspace& threads;
  AlignedVector<double> rows;  ///< per point, the row that kernels gather; see pack

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
};

}  // namespace peristat
