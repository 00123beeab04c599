#pragma once

#include <memory>
#include <string>
#include <vector>

#include "src/geometry/mesh_body.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Where the points of a mesh stand.
enum class PointsAt : std::uint8_t {
  elements,  ///< at the centroid of each element, with its volume
  nodes      ///< at each node that elements have, with an equal share of the volume of each
};

/// Makes points of a mesh, renumbered with locality, with the groups of the mesh as sets, and with
/// `mesh`, `source_row` and, at elements, `elements` and in 2D `polygons`. The spacing is the (mean
/// volume / cross_section)^(1/dimension).
///
/// A set has the points of its elements, or the nodes that these have. Of nodes, and elements of a
/// lower dimension, it has the elements with all nodes of one of them: the elements that have the
/// facet.
/// @param cross_section thickness in 2D [m]
/// @throws InputError ("file") for elements that stand at one place; "cross_section"
[[nodiscard]] Points make_points(std::shared_ptr<const MeshBody> mesh, PointsAt at,
                                 double cross_section, const std::string& file);

/// Numbers of the facets of the boundary that a group of a mesh has; empty: it has none.
[[nodiscard]] std::vector<std::size_t> facets_of(const MeshBody& mesh, const std::string& group);

}  // namespace peristat
