#pragma once

#include <string>
#include <vector>

#include "src/conditions/specification.hpp"
#include "src/core/communicator.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Area that each of some points bears a traction on [m2]: their sum is that of the loaded faces of
/// cells.
struct TractionAreas {
  std::vector<Index> points;
  std::vector<double> area;
};

/// The area of every loaded face, spacing^(d-1) x cross-section, is borne by the point behind it,
/// or shared out over its column of points as far as these reach into the horizon below the face:
/// each by the part of its cell that does.
/// @param key of the load, for errors
/// @param ranks that have parts of the body, a call that all make, with the areas of the points
/// that
///        each owns; null: it is whole
/// @throws InputError for points on no lattice, a side that is none, and a set that does not lie in
///         one plane of points on the boundary, or in more than one
[[nodiscard]] TractionAreas traction_areas(const Points& points, const LoadSpecification& load,
                                           double horizon, const std::string& key,
                                           const Communicator* ranks = nullptr);

}  // namespace peristat
