#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {

/// Cells per search radius. Half the radius leaves 3.7 candidates per bond in 3D instead of 6.1
/// with cells as large as the radius.
inline constexpr int cells_per_radius = 2;

/// Some points in cells of at least radius / cells_per_radius; the last direction is the fastest.
/// Points of a cell are contiguous, in the order of `members`.
template <int D>
struct CellList {
  std::array<double, D> lower{};
  std::array<double, D> cells_per_length{};
  std::array<int, D> extent{};
  std::vector<Index> begin;                     // first place of each cell, cells + 1
  std::vector<Index> point;                     // points in the order of their cells
  std::vector<std::array<double, D>> position;  // their positions in this order

  /// @param place of all points, points x D, row major [m]
  CellList(std::span<const double> place, const std::vector<Index>& members, double radius) {
    std::array<double, D> upper;
    lower.fill(std::numeric_limits<double>::infinity());
    upper.fill(-std::numeric_limits<double>::infinity());
    const auto count = static_cast<Index>(members.size());
    for (const Index i : members) {
      for (int c = 0; c < D; ++c) {
        lower[c] = std::min(lower[c], place[std::size_t(i) * D + c]);
        upper[c] = std::max(upper[c], place[std::size_t(i) * D + c]);
      }
    }
    // Many more cells than points would only cost memory: a cloud with far outliers gets larger
    // ones.
    const double most_cells = 8.0 * count + 64.0;
    std::array<double, D> wanted;
    for (int c = 0; c < D; ++c) {
      const double cells_along =
          (upper[c] - lower[c]) * cells_per_radius / inclusive_radius(radius);
      wanted[c] = std::clamp(std::floor(cells_along), 1.0, most_cells);
    }
    const auto total = [&] {
      return std::accumulate(wanted.begin(), wanted.end(), 1.0, std::multiplies<>());
    };
    while (total() > most_cells) {
      double& largest = *std::max_element(wanted.begin(), wanted.end());
      largest = std::ceil(0.5 * largest);
    }
    const std::size_t cells = std::size_t(total());
    for (int c = 0; c < D; ++c) {
      const double span = upper[c] - lower[c];
      extent[c] = static_cast<int>(wanted[c]);
      cells_per_length[c] = span > 0.0 ? extent[c] / span : 0.0;
    }
    std::vector<Index> cell(members.size());
    begin.assign(cells + 1, 0);
    for (Index k = 0; k < count; ++k) {
      std::size_t flat = 0;
      for (int c = 0; c < D; ++c) {
        flat = flat * extent[c] + coordinate(place[std::size_t(members[k]) * D + c], c);
      }
      cell[k] = static_cast<Index>(flat);
      ++begin[flat + 1];
    }
    for (std::size_t k = 0; k < cells; ++k) begin[k + 1] += begin[k];
    std::vector<Index> next(begin.begin(), begin.end() - 1);
    point.resize(count);
    position.resize(count);
    for (Index k = 0; k < count; ++k) {
      const Index slot = next[cell[k]]++;
      point[slot] = members[k];
      for (int c = 0; c < D; ++c) position[slot][c] = place[std::size_t(members[k]) * D + c];
    }
  }

  [[nodiscard]] int coordinate(double at, int direction) const {
    // Clamped before the conversion: a body whose thickness is round-off has huge numbers here.
    const double cell = (at - lower[direction]) * cells_per_length[direction];
    return static_cast<int>(std::clamp(cell, 0.0, extent[direction] - 1.0));
  }

  /// Calls visit(first, last) for the places of each run of cells along the fastest direction.
  template <class Visit>
  void for_each_run(const std::array<double, D>& at, double radius, const Visit& visit) const {
    std::array<int, D> from, to;
    for (int c = 0; c < D; ++c) {
      from[c] = coordinate(at[c] - radius, c);
      to[c] = coordinate(at[c] + radius, c);
    }
    if constexpr (D == 1) {
      visit(begin[from[0]], begin[to[0] + 1]);
    } else if constexpr (D == 2) {
      for (int a = from[0]; a <= to[0]; ++a) {
        const std::size_t row = std::size_t(a) * extent[1];
        visit(begin[row + from[1]], begin[row + to[1] + 1]);
      }
    } else {
      for (int a = from[0]; a <= to[0]; ++a) {
        for (int b = from[1]; b <= to[1]; ++b) {
          const std::size_t row = (std::size_t(a) * extent[1] + b) * extent[2];
          visit(begin[row + from[2]], begin[row + to[2] + 1]);
        }
      }
    }
  }
};

}  // namespace peristat
