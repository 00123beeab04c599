#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "src/geometry/side.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// A part of a shape's boundary. Boxes: 0 to 5 for x-, x+, y-, y+, z-, z+; polygons: the edge from
/// the vertex of this number; cylinders: 0 round, 1 and 2 the ends against and along the axis;
/// disks, ellipses and spheres: 0.
struct ShapeSide {
  std::size_t shape = 0, side = 0;
  bool operator==(const ShapeSide&) const = default;
};

/// Name of a part of a boundary in messages: "shape 0 side x+", "shape 1".
[[nodiscard]] std::string name_of(const ShapeSide& part, const std::vector<ShapeStep>& shapes);

/// The nearest place on a face of a body.
struct Foot {
  ShapeSide part{};       ///< the boundary that it is on
  Coordinates at{};       ///< [m]
  Coordinates normal{};   ///< of the face there, out of the body, of length 1
  double distance = 0.0;  ///< from the place [m]

  /// Depth of the place below the face's tangent plane; negative in front of it, such as beyond a
  /// concave corner or a gap [m].
  [[nodiscard]] double depth(const Coordinates& place) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) sum += (at[c] - place[c]) * normal[c];
    return sum;
  }
};

/// Among faces whose normals differ by less than this angle the nearest alone counts, so that no
/// traction counts twice where a side continues smoothly, in a polygon with many edges, or on a
/// face one step behind.
inline constexpr double smooth_angle = 30.0;  // degrees

/// Common interface of the boundaries of bodies in 2D and 3D.
class BoundaryFaces {
 public:
  BoundaryFaces() = default;
  BoundaryFaces(const BoundaryFaces&) = delete;
  BoundaryFaces& operator=(const BoundaryFaces&) = delete;
  virtual ~BoundaryFaces() = default;

  /// Appends the nearest place of each face within a distance.
  virtual void append_feet(const Coordinates& place, double distance,
                           std::vector<Foot>& feet) const = 0;
  /// Height along the side's axis of the outermost flat face across it; none if something else
  /// stands out farther.
  [[nodiscard]] virtual std::optional<double> outermost(const Side& side) const = 0;
};

}  // namespace peristat
