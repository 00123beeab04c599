#pragma once

#include <array>
#include <limits>
#include <variant>
#include <vector>

#include "src/types.hpp"

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

/// Closed simple polygon in the x-y plane (2D; in 3D it is unbounded in z).
struct Polygon {
  std::vector<std::array<double, 2>> vertices;
};

using Shape = std::variant<Box, Disk, Cylinder, Sphere, Polygon>;

/// Whether the place lies inside the shape or on its boundary.
[[nodiscard]] bool contains(const Shape& shape, const Coordinates& place);

/// Smallest box around the shape; unbounded directions are infinite.
[[nodiscard]] Box bounds(const Shape& shape);

}  // namespace peristat
