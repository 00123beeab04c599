#pragma once

#include <functional>

#include "src/core/spacing.hpp"
#include "src/neighbourhood/horizon.hpp"
#include "src/neighbourhood/horizon_shape.hpp"

namespace peristat {

/// Part of a neighbour's volume that counts.
enum class VolumeCorrection {
  none,    ///< all of it
  linear,  ///< a share that falls from 1 to 0 over one spacing around the horizon
  exact,   ///< the part of a lattice's cell within the horizon
  /// the same, with influence and length of the bond taken at the part's centroid
  exact_centroids,
};

/// A smaller part of a cell is round-off and counts as none.
inline constexpr double least_share = horizon_tolerance;

/// Share nu of a point's volume inside another's horizon, for the linear correction:
/// (delta + D/2 - r) / D between delta - D/2 and delta + D/2, 1 below, 0 above
/// (r distance, D size of the volume).
[[nodiscard]] double linear_partial_volume(double distance, double horizon, double size);

/// Neighbourhood of a point and how much of it counts: horizon, influence function and partial
/// volumes. Distances passed for shares and influences are in the shape's norm.
struct Kernel {
  int dimension = 2;
  double horizon = 0.0;        ///< delta [m]
  double cross_section = 1.0;  ///< 1D: area A [m2]; 2D: thickness h [m]; 3D: 1
  VolumeCorrection volume_correction = VolumeCorrection::none;
  HorizonShape shape = HorizonShape::ball;  ///< others have no volume correction
  /// omega(norm / delta), by which the weight of a bond is multiplied, see Influence; empty: 1
  std::function<double(double relative_distance)> influence{};

  /// omega without round-off at the horizon: a distance that equals the horizon within round-off is
  /// the horizon, and an influence that vanishes there is 0.
  [[nodiscard]] double influence_at(double distance) const;

  /// True if some points that the search finds may have no weight.
  [[nodiscard]] bool may_be_weightless() const {
    return influence || volume_correction != VolumeCorrection::none || shape != HorizonShape::ball;
  }

  /// True if shares are the exact parts of cells within the horizon, see LatticeKernel.
  [[nodiscard]] bool has_exact_shares() const {
    return volume_correction == VolumeCorrection::exact ||
           volume_correction == VolumeCorrection::exact_centroids;
  }

  /// Largest distance of neighbours, without partial volumes [m].
  [[nodiscard]] double reach() const { return horizon * farthest_of(shape, dimension); }

  /// Share of a volume of some size at a distance that counts, unless shares are exact.
  [[nodiscard]] double partial_volume(double distance, double size) const;

  /// Farthest distance at which cells up to a size count [m].
  [[nodiscard]] double search_radius(const Spacing& largest_size) const;

  /// m_k = int omega r^k dV over the shape of the horizon [m^(k+3)]; m_0 is V_H where omega is 1.
  [[nodiscard]] double moment(int k) const;

  /// The same integral with the shares of volumes of one size, spread evenly: the mean over points
  /// of a cloud. The linear share makes it larger, without influence by the factor
  /// ((1 + q)^(p+1) - (1 - q)^(p+1)) / (2 q (p + 1)), q = size / (2 delta), p = k + dimension.
  [[nodiscard]] double cloud_moment(int k, double size) const;

  /// The same sum over the neighbours of a point inside a lattice, with their partial volumes.
  [[nodiscard]] double lattice_moment(int k, const Spacing& spacing) const;
};

}  // namespace peristat
