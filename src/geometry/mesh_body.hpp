#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/mesh.hpp"
#include "src/geometry/mesh_elements.hpp"

namespace peristat {

/// Body made of a mesh's elements, all of the body's dimension, with its boundary and its groups.
/// Elements are in the order of the file.
struct MeshBody {
  /// A side of exactly one element.
  struct Facet {
    Index element = 0;
    int corners = 0;                ///< 2 in 2D; 3 or 4
    std::array<Index, 4> corner{};  ///< nodes, counter-clockwise seen from outside
  };
  /// Members of a named group of the file.
  struct Group {
    std::vector<Index> elements{};            ///< of the body's dimension
    std::vector<std::vector<Index>> lower{};  ///< corners of each element of a lower dimension
    std::vector<Index> nodes{};
  };

  int dimension = 0;
  MeshElements elements{};  ///< with all nodes of the file, padded to its dimension
  std::vector<std::int32_t> file_element{};  ///< number of each element among all of the file
  std::vector<double> measure{};             ///< area [m2] or volume [m3]
  std::vector<Coordinates> centroid{};       ///< [m]
  std::vector<Facet> boundary{};
  std::map<std::string, Group> groups{};
  std::vector<std::string> remarks{};  ///< for `check` and `points`

  [[nodiscard]] std::size_t count() const { return elements.kind.size(); }
  [[nodiscard]] Coordinates node(Index number) const {
    Coordinates at{};
    for (std::size_t c = 0; c < std::size_t(dimension); ++c)
      at[c] = elements.nodes[std::size_t(number) * std::size_t(dimension) + c];
    return at;
  }
  [[nodiscard]] std::size_t node_count() const {
    return elements.nodes.size() / std::size_t(dimension);
  }
  /// Nodes at the corners of an element.
  [[nodiscard]] std::vector<Index> corners_of(std::size_t element) const {
    const auto first = elements.corners.begin();
    return {first + std::ptrdiff_t(elements.offset[element]),
            first + std::ptrdiff_t(elements.offset[element + 1])};
  }
};

/// "120 triangles, 4 quadrilaterals".
[[nodiscard]] std::string element_counts(const MeshBody& mesh);

/// Distance, relative to the size of the elements there, up to which a node lies on a facet. Twice
/// the depth by which a bond may leave the body (MeshInterior), so that the sides of a slit that
/// bonds would bridge are refused.
inline constexpr double touching_facets = 2e-3;

/// Checks a mesh and makes a body of it. Elements whose corners have the order of a mirrored
/// element are reordered. Nodes that no element has are ignored.
/// @param file named in errors
/// @throws InputError ("file") with the number of the element or node (counted from 1, in the order
///         of the file) if there are no elements of the dimension or others of a higher one;
///         unknown types; nodes that are missing or not finite, or not in one plane (2D); elements
///         without volume, twisted or not convex, or that name a node twice; elements that overlap,
///         sides of more than two elements, nodes at one place, hanging nodes; groups with names
///         that can't be used
[[nodiscard]] std::shared_ptr<const MeshBody> make_mesh_body(const Mesh& mesh, int dimension,
                                                             const std::string& file);

}  // namespace peristat
