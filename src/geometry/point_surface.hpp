#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Points of a facet, ascending; in 2D the last one is -1.
using FacetCorners = std::array<Index, 3>;

/// Surface that joins the outermost points of a body: segments in 2D, triangles in 3D. It is the
/// boundary of the simplices of a Delaunay triangulation that are part of the body: all their
/// corners are joined, and the circumscribed radius is at most 1.25 times the size of a corner. The
/// faces of a crack, whose points are not joined, are therefore part of it; those along rows or
/// diagonals of a lattice are flat.
/// @param size of each point [m]
/// @param are_joined whether two points are one piece
/// @return facets, ascending; none in 1D, and none where no simplex is, as in rows of single points
[[nodiscard]] std::vector<FacetCorners> surface_of_points(
    const Points& points, std::span<const double> size,
    const std::function<bool(Index, Index)>& are_joined);

}  // namespace peristat
