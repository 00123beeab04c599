#pragma once

#include <cstddef>

#include "src/geometry/points.hpp"

namespace peristat {

/// Whether the part of a body that these points are counts a bond, which all parts together do
/// once: of a bond between two parts the one that owns the end which comes first by its place. Of a
/// whole body, every bond.
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
