#pragma once

#include <array>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Axis-aligned box; in 1D an interval, in 2D a rectangle.
struct Box {
  Coordinates min{}, max{};
};

/// Circle in the x-y plane (2D).
struct Disk {
  Coordinates centre{};
  double radius = 0.0;
};

/// Circular cylinder around an axis through `centre` (3D); `length` is measured symmetrically
/// about the centre and may be infinite.
struct Cylinder {
  Coordinates centre{};
  Coordinates axis{0.0, 0.0, 1.0};
  double radius = 0.0;
  double length = std::numeric_limits<double>::infinity();
};

struct Sphere {
  Coordinates centre{};
  double radius = 0.0;
};

/// Closed simple polygon in the x-y plane (2D; in 3D it is unbounded in z); the last vertex is
/// joined to the first.
struct Polygon {
  std::vector<std::array<double, 2>> vertices;
};

/// Distance outside a shape, relative to the shape's size, that still counts as its boundary: far
/// above the round-off of lattice coordinates, far below a spacing.
inline constexpr double boundary_tolerance = 1e-9;

using Shape = std::variant<Box, Disk, Cylinder, Sphere, Polygon>;

/// Refuses a shape that has no inside or that does not fit the dimension (disk: 2; cylinder,
/// sphere: 3; polygon: 2 or 3; box: all). Only a box and a cylinder's length may be infinite.
/// @param table    table of the shape's numbers, for errors ("shapes[0]")
/// @param kind_key key that names the kind of shape ("shapes[0].action")
/// @throws InputError
void check_shape(const Shape& shape, int dimension, const std::string& table,
                 const std::string& kind_key);

/// True if the place lies inside the shape or, up to `boundary_tolerance`, on its boundary.
[[nodiscard]] bool contains(const Shape& shape, const Coordinates& place);

/// Smallest box around the shape; unbounded directions are infinite.
[[nodiscard]] Box bounds(const Shape& shape);

}  // namespace peristat
