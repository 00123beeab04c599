#pragma once

#include <cstdint>

namespace peristat {

/// Neighbourhood of a point far from all surfaces of a lattice.
struct BulkNeighbourhood {
  double volume = 0.0;          ///< V_H of the ball: 2D pi delta^2 h, 3D 4/3 pi delta^3 [m3]
  std::int64_t neighbours = 0;  ///< #N1
  std::int64_t pairs = 0;       ///< #N2, ordered: all mutual distances within the horizon, not
                                ///< collinear
  std::int64_t triplets = 0;    ///< #N3, ordered: … and not coplanar; 0 in 2D
};

/// Largest horizon / spacing for which the pairs (2D) and triplets (3D) are counted: above it that
/// takes minutes, whatever the body's size.
[[nodiscard]] constexpr double largest_ratio_with_pairs(int dimension) {
  return dimension == 2 ? 50.0 : 8.0;
}

/// @param cross_section thickness h in 2D [m], 1 in 3D
[[nodiscard]] BulkNeighbourhood bulk_neighbourhood(int dimension, double spacing, double horizon,
                                                   double cross_section);

}  // namespace peristat
