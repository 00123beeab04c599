#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/mesh_elements.hpp"

namespace peristat {

/// Corners, sides and parametrisation of a linear element. Corners have VTK's order.
struct ElementShape {
  MeshElements::Kind kind{};
  const char* type = "";  ///< meshio's name
  const char* name = "";  ///< in messages: "tetrahedron"
  const char* plural = "";
  int dimension = 0;
  int corners = 0;
  /// The element is a square (2D) or cube (3D) with corners that coincide: its corner at each
  /// corner of the square or cube.
  std::array<int, 8> brick{};
  /// Corners of each side, counter-clockwise seen from outside (2D: the element on the left).
  std::vector<std::vector<int>> sides{};
  /// Corners that edges join to each corner, right-handed if the element is; corners without a
  /// row, such as a pyramid's apex, have more than three.
  std::vector<std::array<int, 4>> trihedra{};  ///< corner, and three others (2D: two)
  std::vector<int> mirrored{};                 ///< order of the corners of the mirrored element
};

[[nodiscard]] const ElementShape& shape_of(MeshElements::Kind kind);

/// Shape by meshio's name without the number of nodes ("hexahedron" for "hexahedron20"); null: an
/// element that is no linear or second-order line, face or solid.
[[nodiscard]] const ElementShape* shape_of_type(const std::string& type);

/// Length, area or volume of an element, and its centroid.
struct ElementMeasure {
  double measure = 0.0;  ///< negative if the order of the corners is that of the mirrored element
  Coordinates centroid{};
  /// Least and largest determinant of the parametrisation at the corners: of different sign in an
  /// element that is twisted or not convex.
  double least = 0.0, largest = 0.0;
};

/// Integrates over an element of dimension 2 or 3:
///
///   V = int det J,   c = 1/V int x det J   over the square or cube that collapses to the element
///
/// by 2 points of Gauss in each direction, which is exact: the integrands have degree 3 at most in
/// each coordinate, also for faces that are not plane (bilinear).
/// @param corners positions, padded with zeros in 2D [m]
[[nodiscard]] ElementMeasure measure_of(const ElementShape& shape,
                                        std::span<const Coordinates> corners);

}  // namespace peristat
