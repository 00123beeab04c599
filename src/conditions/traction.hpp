#pragma once

#include <string>
#include <vector>

#include "src/conditions/specification.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Area over which each of some points carries a traction [m2]; the sum is the area of the loaded
/// faces of cells.
struct TractionAreas {
  std::vector<Index> points;
  std::vector<double> area;
};

/// Assigns the area of every loaded face, spacing^(d-1) x cross-section, to the point behind it, or
/// distributes it over the column of points within the horizon below the face, in proportion to the
/// part of each cell that lies within.
/// @param key of the load, for errors
/// @param ranks that have parts of the body (collective): each rank gets the areas of the points
///        that it owns
/// For a mesh see loaded_facets.hpp.
/// @throws InputError for points of a cloud, a side that the body does not have, and a set that
///         does not lie in exactly one plane of points on the boundary
[[nodiscard]] TractionAreas traction_areas(const Points& points, const LoadSpecification& load,
                                           double horizon, const std::string& key,
                                           const Communicator& ranks = sole_rank());

}  // namespace peristat
