#pragma once

#include <span>

#include "src/core/types.hpp"

namespace peristat {

/// |x_j - x_i|^2 [m2]
/// @param positions points x dimension [m]
[[nodiscard]] inline double squared_distance(std::span<const double> positions, int dimension,
                                             Index i, Index j) {
  double squared = 0.0;
  for (int c = 0; c < dimension; ++c) {
    const double x = positions[std::size_t(j) * std::size_t(dimension) + std::size_t(c)] -
                     positions[std::size_t(i) * std::size_t(dimension) + std::size_t(c)];
    squared += x * x;
  }
  return squared;
}

}  // namespace peristat
