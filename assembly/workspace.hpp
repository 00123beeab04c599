#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "assembly/local_workspace.hpp"
#include "assembly/model.hpp"
#include "assembly/pattern.hpp"
#include "assembly/stored.hpp"
#include "src/aligned_vector.hpp"
#include "src/points/points.hpp"
#include "src/threads.hpp"

namespace peristat {

/// Doubles of a gathered row: two vectors of the dimension, each padded to a transposition's width
/// where they don't fit one together.
constexpr int row_width(int dimension) { return dimension == 3 ? 8 : 4; }

/// Doubles of a point's sum: of a vector, and of the upper half of a symmetric block.
constexpr int vector_width(int dimension) { return dimension == 3 ? 4 : dimension; }
constexpr int block_width(int dimension) { return dimension == 3 ? 6 : 4; }

/// What the passes over the interactions work with: the threads' ranges of rows and their buffers,
/// all allocated once.
struct Workspace {
  Workspace(const Points& of, const Model& with, int threads);

  const Points& points;
  const Model& model;
  std::vector<RowRange> ranges;
  AlignedVector<double> rows;               ///< per point, what kernels gather; see pack
  std::vector<AlignedVector<double>> sums;  ///< per thread, rows first..reach of what it adds up
  std::vector<Stored> stored;               ///< per thread
  std::vector<double> longest;              ///< per thread, largest stretch

  // Only for models with more than bonds.
  std::vector<std::vector<double>> blocks;  ///< per thread, off-diagonal blocks of rows last..reach
  std::variant<std::monostate, std::vector<std::unique_ptr<LocalWorkspace<2>>>,
               std::vector<std::unique_ptr<LocalWorkspace<3>>>>
      local;  ///< per thread

  [[nodiscard]] int threads() const { return static_cast<int>(ranges.size()); }

  template <int D>
  [[nodiscard]] LocalWorkspace<D>& local_of(int thread) {
    return *std::get<std::vector<std::unique_ptr<LocalWorkspace<D>>>>(local)[std::size_t(thread)];
  }

  /// Gathered rows: two vectors per point, e.g. reference position and displacement.
  template <int D>
  void pack(std::span<const double> first, std::span<const double> second) {
    constexpr int width = row_width(D);
    const Index count = points.count();
#pragma omp parallel for num_threads(threads())
    for (Index i = 0; i < count; ++i) {
      double* row = &rows[std::size_t(i) * width];
      for (int c = 0; c < D; ++c) {
        row[c] = first[std::size_t(i) * D + c];
        row[width / 2 + c] = second[std::size_t(i) * D + c];
      }
    }
  }

  /// Runs body(thread, range, sums) on every thread with cleared sums of `width` doubles per row,
  /// then finish(thread, range), and write(row, total) with the threads' sums added up in order.
  template <int width, class Body, class Write, class Finish>
  void sum_rows(const Body& body, const Write& write, const Finish& finish) {
    run_on_threads(threads(), [&](int thread) {
      const RowRange range = ranges[thread];
      double* own = sums[thread].data();
      std::fill_n(own, std::size_t(range.reach - range.first) * width, 0.0);
      if (range.last > range.first) body(thread, range, own - std::ptrdiff_t(range.first) * width);
#pragma omp barrier
      finish(thread, range);
      for (Index i = range.first; i < range.last; ++i) {
        double* total = own + std::size_t(i - range.first) * width;
        for (int earlier = 0; earlier < thread; ++earlier) {
          const RowRange other = ranges[earlier];
          if (i >= other.reach) continue;
          const double* spilled = &sums[earlier][std::size_t(i - other.first) * width];
          for (int c = 0; c < width; ++c) total[c] += spilled[c];
        }
        write(i, total);
      }
    });
  }

  template <int width, class Body, class Write>
  void sum_rows(const Body& body, const Write& write) {
    sum_rows<width>(body, write, [](int, RowRange) {});
  }

  /// What the threads found, together.
  [[nodiscard]] Stored total_stored() const {
    Stored total;
    for (const Stored& part : stored) {
      total.energy += part.energy;
      total.degenerate |= part.degenerate;
      total.growth.degrading += part.growth.degrading;
      total.growth.breaking += part.growth.breaking;
      total.growth.utilisation = std::max(total.growth.utilisation, part.growth.utilisation);
    }
    total.degenerate |= !std::isfinite(total.energy);
    return total;
  }
};

}  // namespace peristat
