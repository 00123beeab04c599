#pragma once

#include <functional>
#include <vector>

#include "src/geometry/convex_cell.hpp"

namespace peristat {

/// Finds the Voronoi cells of places in a box: the part of the box that is nearer to a place than
/// to any other one. Uses Voro++ (Rycroft 2009) in units of the spacing, since its tolerance,
/// 1e-11, is absolute.
/// @param dimension 2 or 3
/// @param places    in the box, no two of them the same
/// @param spacing   about the distance of neighbours [m]
/// @param visit     gets the number of a place and its cell, once for each, in no order
/// @throws std::logic_error for a place that has no cell
void for_each_voronoi_cell(int dimension, const Box& box, double spacing,
                           const std::vector<Coordinates>& places,
                           const std::function<void(std::size_t, const ConvexCell&)>& visit);

}  // namespace peristat
