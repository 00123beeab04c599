#pragma once

#include <array>
#include <cmath>

#include "src/core/coordinates.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Place of a point or of the nearest place of a closed segment or triangle, by the corners.
using CornerWeights = std::array<double, 3>;

/// Corners of a vertex, segment or triangle as a point sees them.
struct FacetArms {
  int corners = 0;
  std::array<Coordinates, 3> reference{};  ///< from the point to the corners at rest [m]
  std::array<Coordinates, 3> moved{};      ///< change of these [m]

  [[nodiscard]] Coordinates present(int corner) const {
    return plus(reference[std::size_t(corner)], moved[std::size_t(corner)]);
  }
};

/// How a point stands to the nearest place of a facet.
struct FacetApproach {
  CornerWeights weight{};  ///< of the corners at that place; their sum is 1
  double distance = 0.0;   ///< r [m]
  Coordinates normal{};    ///< from the place to the point
  double overlap = 0.0;    ///< d - r [m]
  double round_off = 0.0;  ///< of that [m]
};

/// @param touching d, distance of contact [m]
[[nodiscard]] FacetApproach approach(const FacetArms& arms, double touching);

/// The distance alone [m].
[[nodiscard]] double facet_distance(const FacetArms& arms);

/// Derivatives of the distance r by the places of the point and of the corners, in this order. With
/// C = (I, -beta_k I), the tangents T of the facet, and G = T^T C + (dT)^T r n:
///
///   r' = C^T n,   r'' = (C^T C - G^T (T^T T)^-1 G - r' r'^T) / r,
///
/// which follows from r^2 / 2 as its minimum over the weights.
struct DistanceDerivatives {
  static constexpr std::size_t most = 12;  ///< numbers: 4 places in space
  std::array<double, most> first{};
  std::array<std::array<double, most>, most> second{};  ///< [1/m]
};
/// @param dimension 2 or 3: places have as many numbers
[[nodiscard]] DistanceDerivatives derivatives(const FacetArms& arms, const FacetApproach& at,
                                              int dimension);

}  // namespace peristat
