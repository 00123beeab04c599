#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Elements of a mesh as cells of points: one per point, without images.
struct MeshElements {
  /// Shapes of elements, by their numbers in VTK; corners are in VTK's order, too.
  enum class Kind : std::uint8_t {
    line = 3,
    triangle = 5,
    quadrilateral = 9,
    tetrahedron = 10,
    hexahedron = 12,
    wedge = 13,
    pyramid = 14
  };

  std::vector<double> nodes{};        ///< positions, count x dimension, row major [m]
  std::vector<Kind> kind{};           ///< per point; empty: there are no elements
  std::vector<std::size_t> offset{};  ///< first corner of each point's element, and the end
  std::vector<Index> corners{};       ///< numbers of nodes

  [[nodiscard]] bool empty() const { return kind.empty(); }
};

}  // namespace peristat
