#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "src/conditions/specification.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Exposed faces of the cells of a lattice body, or facets of a mesh, on which pressures act. A
/// corner moves with the body's points around it, in the same way for all faces that share it, so
/// that these stay together as the body deforms.
struct PressedBoundary {
  std::vector<Coordinates> corner;  ///< in the reference [m]
  std::vector<std::vector<Index>>
      adjacent;  ///< the body's points within a cell and a half of each corner
  /// Corners of each face, seen from outside counter-clockwise: 1, 2 or 4 in 1D, 2D, 3D.
  std::vector<std::array<Index, 4>> face;
  std::vector<double> sign;         ///< 1D: of the outward normal, per face
  std::vector<Coordinates> centre;  ///< of each face in the reference [m]
  double cross_section = 1.0;       ///< 1D: area [m2]; 2D: thickness [m]
};

/// Adds to a boundary the faces of a load's `side`, or the exposed faces of the points of its `set`
/// (on its side alone, if it has both). For a mesh see loaded_facets.hpp.
/// @param key of the load, for errors
/// @param ranks that have parts of the body with ghosts as far as reach_of_pressures (collective):
///        each rank gets the faces whose corners move with points of its own. Null: the body is
///        whole
/// @throws InputError for points on no lattice, a side that the body does not have, a set without
///         exposed faces
void add_pressed_faces(const Points& points, const LoadSpecification& load, const std::string& key,
                       PressedBoundary& boundary, const Communicator& ranks = sole_rank());

/// Distance over which a part needs ghosts for the faces that press on its points: across a face,
/// to the points that its corners move with, and to the points that cover it [m].
[[nodiscard]] double reach_of_pressures(const Points& points);

/// Forces on the faces in the reference, faces x dimension [N].
[[nodiscard]] std::vector<double> face_forces(const PressedBoundary& boundary,
                                              std::span<const double> pressure, int dimension);

}  // namespace peristat
