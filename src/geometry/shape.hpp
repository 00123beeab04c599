#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

class ClosedSurface;
struct Pixels;

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
  std::filesystem::path file{};  ///< that they are read from by read_outline; may be empty
  double scale = 1.0;            ///< of the file's coordinates [m]
};

/// Ellipse in the x-y plane (2D): radius `radii[0]` along its first axis, which is turned by
/// `angle` [degrees] from x towards y, and `radii[1]` along the other.
struct Ellipse {
  Coordinates centre{}, radii{};
  double angle = 0.0;
};

/// The parts of a rectangle where an image that fills it has values of grey in a range (2D). Row 0
/// is at the top, where y is largest.
struct PixelImage {
  std::filesystem::path file;
  Coordinates min{}, max{};
  std::array<double, 2> grey{};            ///< least and largest, both included
  std::shared_ptr<const Pixels> pixels{};  ///< read from the file by read_pixels
};

/// The inside of a closed surface of triangles (3D).
struct StlBody {
  std::filesystem::path file;
  double scale = 1.0;                              ///< of the file's coordinates [m]
  Coordinates translate{};                         ///< added to the scaled coordinates [m]
  std::shared_ptr<const ClosedSurface> surface{};  ///< read from the file by read_stl
};

/// Least radius of an ellipse relative to the other: far above `boundary_tolerance`.
inline constexpr double thinnest_ellipse = 1e-6;

/// Distance outside a shape, relative to the shape's size, that still counts as its boundary: far
/// above the round-off of lattice coordinates, far below a spacing.
inline constexpr double boundary_tolerance = 1e-9;

using Shape = std::variant<Box, Disk, Cylinder, Sphere, Polygon, Ellipse, PixelImage, StlBody>;

/// Refuses a shape that has no inside or that does not fit the dimension (disk, ellipse, image: 2;
/// cylinder, sphere, stl: 3; polygon: 2 or 3; box: all). Only a box and a cylinder's length may be
/// infinite.
/// @param table    table of the shape's numbers, for errors ("shapes[0]")
/// @param kind_key key that names the kind of shape ("shapes[0].action")
/// @throws InputError
void check_shape(const Shape& shape, int dimension, const std::string& table,
                 const std::string& kind_key);

/// False for images and surfaces of triangles, whose many small sides stand for a curved boundary.
[[nodiscard]] inline bool has_smooth_sides(const Shape& shape) {
  return !std::holds_alternative<PixelImage>(shape) && !std::holds_alternative<StlBody>(shape);
}

/// The file that a shape is read from, or an empty path.
[[nodiscard]] std::filesystem::path file_of(const Shape& shape);

/// True if the place lies inside the shape or, up to `boundary_tolerance`, on its boundary.
[[nodiscard]] bool contains(const Shape& shape, const Coordinates& place);

/// True if all shapes of this kind are convex.
[[nodiscard]] inline bool is_convex(const Shape& shape) {
  return !std::holds_alternative<Polygon>(shape) && has_smooth_sides(shape);
}

/// Smallest box around the shape; unbounded directions are infinite.
[[nodiscard]] Box bounds(const Shape& shape);

}  // namespace peristat
