#pragma once

#include "src/geometry/box_in_ball.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/kernel.hpp"

namespace peristat {

/// A kernel for points whose cells are polygons, or intervals of a line, each of its own form: the
/// counterpart of LatticeKernel.
class PolygonKernel {
 public:
  /// @param points with `polygons`; they must outlive this
  PolygonKernel(const Points& points, const Kernel& kernel);

  /// Factor of a bond's weight beside the volumes of its points,
  ///
  ///   1/2 (nu_ij omega(r'_ij) r'_ij + nu_ji omega(r'_ji) r'_ji) / r,
  ///
  /// with the share nu_ij of j's cell within the horizon of i, and the distance r'_ij at which i
  /// counts it, that of the points or, with `exact_centroids`, of the part's centroid. 0 for points
  /// that are no neighbours.
  [[nodiscard]] double factor(Index i, Index j, double distance) const;

  /// Part of a point's cell, or of an image's, in the ball of the horizon about another point; in
  /// 1D the area is a length. Exact to round-off of the cell.
  [[nodiscard]] PolygonPart part(Index of, Index about) const;

  /// Farthest distance at which cells count [m].
  [[nodiscard]] double search_radius() const { return kernel_.horizon + farthest_; }

 private:
  [[nodiscard]] double one_sided(Index i, Index j, double distance) const;

  const Points& points_;
  const Kernel kernel_;
  std::vector<double> reach_;  // of the cell of each point that is no image [m]
  double farthest_ = 0.0;
};

}  // namespace peristat
