#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "assembly/energy/evaluation.hpp"
#include "assembly/operators/block_pattern.hpp"
#include "src/core/aligned_vector.hpp"
#include "src/core/threads.hpp"

namespace peristat {

/// Doubles per point of a sum: of a vector, and of the upper half of a symmetric block.
constexpr int vector_width(int dimension) { return dimension == 3 ? 4 : dimension; }
constexpr int block_width(int dimension) { return dimension == 3 ? 6 : 4; }

/// Buffers in which the passes of all terms sum: the threads' ranges of rows and their sums,
/// allocated once; without couplings on first use.
struct Workspace {
  Workspace(const BlockPattern& pattern, int dimension, int threads);

  std::vector<RowRange> ranges;
  std::vector<AlignedVector<double>>
      sums;                             ///< per thread, rows first..touched_end of what it adds up
  std::vector<Evaluation> evaluations;  ///< per thread

  [[nodiscard]] int threads() const { return static_cast<int>(ranges.size()); }

  /// Runs body(thread, range, sums) on every thread with cleared sums of `width` doubles per row,
  /// then finish(thread, range), and write(row, total) with the threads' sums added up in order.
  template <int width, class Body, class Write, class Finish>
  void sum_rows(const Body& body, const Write& write, const Finish& finish) {
    make_room(width);
    run_on_threads(threads(), [&](int thread) {
      const RowRange range = ranges[thread];
      double* own = sums[thread].data();
      std::fill_n(own, std::size_t(range.touched_end - range.first) * width, 0.0);
      if (range.last > range.first) body(thread, range, own - std::ptrdiff_t(range.first) * width);
#pragma omp barrier
      finish(thread, range);
      for (Index i = range.first; i < range.last; ++i) {
        double* total = own + std::size_t(i - range.first) * width;
        for (int earlier = 0; earlier < thread; ++earlier) {
          const RowRange other = ranges[earlier];
          if (i >= other.touched_end) continue;
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

  /// Sum of the threads' evaluations.
  [[nodiscard]] Evaluation total_evaluation() const {
    Evaluation total;
    for (const Evaluation& part : evaluations) total += part;
    total.degenerate |= !std::isfinite(total.energy);
    return total;
  }

 private:
  /// Grows the sums to so many doubles per row.
  void make_room(int width);
};

}  // namespace peristat
