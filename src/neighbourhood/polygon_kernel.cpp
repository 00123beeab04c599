#include "src/neighbourhood/polygon_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {
namespace {

/// Part of an interval in the interval of a radius about the origin.
PolygonPart interval_in_interval(const std::vector<PlaneVector>& ends, double radius) {
  const auto [low, high] = std::minmax(ends[0][0], ends[1][0]);
  const double from = std::max(low, -radius), to = std::min(high, radius);
  if (!(to > from)) return {};
  return {to - from, {0.5 * (to - from) * (to + from), 0.0}};
}

}  // namespace

PolygonKernel::PolygonKernel(const Points& points, const Kernel& kernel)
    : points_(points), kernel_(kernel) {
  for (std::size_t i = 0; i < std::size_t(points.own()); ++i) {
    double reach = 0.0;
    for (const PlaneVector& corner : points.polygons.of(i))
      reach = std::max(reach, std::hypot(corner[0], corner[1]));
    reach_.push_back(reach);
    farthest_ = std::max(farthest_, reach);
  }
}

double PolygonKernel::factor(Index i, Index j, double distance) const {
  return 0.5 * (one_sided(i, j, distance) + one_sided(j, i, distance));
}

PolygonPart PolygonKernel::part(Index of, Index about) const {
  std::vector<PlaneVector> corners = points_.polygons.of(std::size_t(points_.source(of)));
  const Coordinates at = points_.position(of), from = points_.position(about);
  double handed = 1.0;
  for (std::size_t c = 0; c < std::size_t(points_.dimension); ++c) {
    const double mirror = points_.is_image(of) ? points_.image_kind(of).mirror[c] : 1.0;
    handed *= mirror;
    for (PlaneVector& corner : corners) corner[c] = mirror * corner[c] + (at[c] - from[c]);
  }
  if (points_.dimension == 1) return interval_in_interval(corners, kernel_.horizon);
  if (handed < 0.0) std::reverse(corners.begin(), corners.end());
  return polygon_in_disk(corners, kernel_.horizon);
}

double PolygonKernel::one_sided(Index i, Index j, double distance) const {
  const double reach = reach_[std::size_t(points_.source(j))];
  if (distance - reach >= kernel_.horizon) return 0.0;
  // A whole cell's centroid is its point.
  if (distance + reach <= kernel_.horizon) return kernel_.influence_at(distance);
  const PolygonPart found = part(j, i);
  const double share =
      found.area * kernel_.cross_section / points_.volume[std::size_t(points_.source(j))];
  if (share < least_share) return 0.0;
  const double counted = kernel_.volume_correction == VolumeCorrection::exact
                             ? distance
                             : std::hypot(found.moment[0], found.moment[1]) / found.area;
  return std::min(share, 1.0) * kernel_.influence_at(counted) * counted / distance;
}

}  // namespace peristat
