#pragma once

#include <array>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

using PlaneVector = std::array<double, 2>;

/// The part of a polygon that lies in a disk.
struct PolygonPart {
  double area = 0.0;
  PlaneVector moment{};  ///< int x dA about the disk's centre
};

/// Part of a convex polygon in the disk of some radius about the origin, in every case to round-off
/// of the polygon's area: whole polygons and disks, polygons that the circle cuts in two, three or
/// more places, and none. It is the polygon of the places where sides enter and leave the disk, and
/// a circular segment between each exit and the next entry: with the chord l and the angle theta
///
///   A = r^2 (theta - sin theta) / 2,   int x dA = l^3 / 12 along the bisector of theta.
///
/// @param corners anticlockwise
[[nodiscard]] PolygonPart polygon_in_disk(const std::vector<PlaneVector>& corners, double radius);

/// The part of a box that lies in a ball.
struct BoxPart {
  double share = 0.0;      ///< of the box, 0 to 1; within round-off of these exactly 0 or 1
  Coordinates centroid{};  ///< of the part, from the ball's centre [m]
};

/// Part of an interval, rectangle or box along the axes in the interval, disk or ball of some
/// radius about the origin. 1D and 2D are in closed form. The volume in 3D is the integral of the
/// areas of its sections, between the heights at which they kink, to round-off; the centroid
/// follows from Gauss's theorem,
///
///   4 int x dV = sum over faces d int x dA + r int x dA over the sphere,
///   int x dA over the sphere = -r sum over faces n A,
///
/// with d the distance of a face's plane along its normal n.
/// @param centre of the box [m]
/// @param edges  its lengths [m]
[[nodiscard]] BoxPart box_in_ball(const Coordinates& centre, const Coordinates& edges,
                                  double radius, int dimension);

}  // namespace peristat
