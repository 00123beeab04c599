#pragma once

#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/polyhedron_in_body.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// A convex polygon (2D) or polyhedron (3D) around a place, with its area or volume.
struct ConvexCell {
  int dimension = 2;
  Coordinates place{};
  std::vector<Coordinates> corners{};             ///< from the place [m]; in 2D anticlockwise
  std::vector<std::vector<std::size_t>> faces{};  ///< in 3D, the corners around each
  double volume = 0.0;                            ///< [m2] in 2D, [m3]
  Coordinates centroid{};                         ///< [m]

  /// Distance of its farthest corner from the place [m].
  [[nodiscard]] double reach() const;
};

/// Part of a cell that lies in a body.
struct PartInBody {
  double volume = 0.0;     ///< [m2] in 2D, [m3]
  Coordinates centroid{};  ///< [m]
  bool is_whole = true;    ///< true if it is the cell itself, to the last bit
};

/// Returns the part of a cell that lies in a body. A cell in one convex shape is whole. Other parts
/// are measured: in 2D like those of lattice cells (see piece_of) in the box around the cell, to
/// 1e-9 of that box, or 1e-5 where boundaries of two shapes cross in it; in 3D by rays (see
/// polyhedron_in_body), with the given accuracy.
[[nodiscard]] PartInBody part_in_body(const ConvexCell& cell, const Solid& body,
                                      Accuracy accuracy = Accuracy::fine);

}  // namespace peristat
