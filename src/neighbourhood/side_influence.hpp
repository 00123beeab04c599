#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "src/core/types.hpp"
#include "src/neighbourhood/kernel.hpp"

namespace peristat {

/// Influence of a triangle or tetrahedron: the product of those of its sides, so that it vanishes
/// with that of any side.
template <std::size_t points>
[[nodiscard]] double influence_of_sides(const Kernel& kernel,
                                        const std::array<Coordinates, points>& at) {
  if (!kernel.influence) return 1.0;
  double product = 1.0;
  for (std::size_t a = 0; a < points; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double side = std::hypot(at[a][0] - at[b][0], at[a][1] - at[b][1], at[a][2] - at[b][2]);
      product *= kernel.influence_at(side);
    }
  }
  return product;
}

}  // namespace peristat
