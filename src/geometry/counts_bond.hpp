#pragma once

#include <cstddef>

#include "src/geometry/points.hpp"

namespace peristat {

/// True if these points' part of a body counts a bond. All parts together count each bond once: a
/// bond between two parts is counted by the owner of the end that comes first by position. For a
/// whole body every bond counts.
[[nodiscard]] inline bool counts_bond(const Points& points, Index i, Index j) {
  if (!points.owned) return true;
  const bool owns_i = points.owns(i), owns_j = points.owns(j);
  if (owns_i == owns_j) return owns_i;
  const auto d = std::size_t(points.dimension);
  const double* const at_i = &points.reference[std::size_t(i) * d];
  const double* const at_j = &points.reference[std::size_t(j) * d];
  std::size_t c = 0;
  while (c + 1 < d && at_i[c] == at_j[c]) ++c;
  return owns_i == (at_i[c] < at_j[c]);
}

}  // namespace peristat
