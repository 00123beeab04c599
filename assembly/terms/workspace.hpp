#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "assembly/energy/evaluation.hpp"
#include "assembly/operators/row_ranges.hpp"
#include "src/core/raw_buffer.hpp"
#include "src/core/threads.hpp"

namespace peristat {

/// Doubles per point of a sum: of a vector, and of the upper half of a symmetric block.
constexpr int vector_width(int dimension) { return dimension == 3 ? 4 : dimension; }
constexpr int block_width(int dimension) { return dimension == 3 ? 6 : 4; }

/// Buffers in which the passes of all terms sum: the parts of the rows and their sums, allocated
/// once; without couplings on first use. Sums of parts are added up in the order of the parts, so
/// that they have the same bits on any number of threads that has the same parts.
struct Workspace {
  /// @param of_parts see partition_rows
  Workspace(const BlockPattern& pattern, int dimension, int on_threads,
            std::vector<RowRange> of_parts);

  std::vector<RowRange> ranges;         ///< per part
  std::vector<RawBuffer> sums;          ///< per part, rows first..touched_end of what it adds up
  std::vector<Evaluation> evaluations;  ///< per part

  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] int parts() const { return static_cast<int>(ranges.size()); }

  /// Runs body(part, range, sums) for every part with cleared sums of `width` doubles per row, then
  /// finish(part, range), and write(row, total) with the parts' sums added up in order.
  template <int width, class Body, class Write, class Finish>
  void sum_rows(const Body& body, const Write& write, const Finish& finish) {
    make_room(width);
    const int busy = std::min(threads(), parts());
    run_on_threads(busy, [&](int thread) {
      for_parts_of_thread(thread, busy, parts(), [&](int part) {
        const RowRange range = ranges[part];
        double* own = sums[part].data();
        double* const rows = own - std::ptrdiff_t(range.first) * width;
        const auto clear = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
          std::fill(rows + first * width, rows + last * width, 0.0);
        };
        clear(range.first, range.last);
        range.for_each_beyond(clear);
        if (range.last > range.first) body(part, range, rows);
      });
#pragma omp barrier
      for_parts_of_thread(thread, busy, parts(), [&](int part) {
        finish(part, ranges[part]);
        add_spilled<width>(part);
        const RowRange range = ranges[part];
        const double* total = sums[part].data();
        for (Index i = range.first; i < range.last; ++i, total += width) write(i, total);
      });
    });
  }

  template <int width, class Body, class Write>
  void sum_rows(const Body& body, const Write& write) {
    sum_rows<width>(body, write, [](int, RowRange) {});
  }

  /// Sum of the parts' evaluations.
  [[nodiscard]] Evaluation total_evaluation() const {
    Evaluation total;
    for (const Evaluation& part : evaluations) total += part;
    total.degenerate |= !std::isfinite(total.energy);
    return total;
  }

 private:
  /// Grows the sums to so many doubles per row.
  void make_room(int width);

  /// Adds what earlier parts have for the rows of this one.
  template <int width>
  void add_spilled(int part) {
    const RowRange range = ranges[part];
    for (int earlier = 0; earlier < part; ++earlier) {
      const RowRange other = ranges[earlier];
      other.for_each_beyond(range, [&](Index first, Index last) {
        const double* const from = sums[earlier].data() + std::size_t(first - other.first) * width;
        double* const to = sums[part].data() + std::size_t(first - range.first) * width;
        for (std::size_t k = 0; k < std::size_t(last - first) * width; ++k) to[k] += from[k];
      });
    }
  }

  int threads_;
};

}  // namespace peristat
