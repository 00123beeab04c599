#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "src/geometry/shape.hpp"
#include "src/geometry/shape_boundary.hpp"

namespace peristat {

/// A closed surface of triangles, whose orientation does not matter: a place is inside if a ray
/// from it crosses the surface an odd number of times, so a shell in a shell is a cavity.
/// Predicates are exact, by CGAL. The queries may be called by many threads.
class ClosedSurface {
 public:
  using Triangle = std::array<std::size_t, 3>;

  /// Triangles without an area are left out, and needles between others are joined to these.
  /// @throws InputError ("file") if it is no closed surface: if an edge does not belong to two
  ///         triangles, with the number of such edges and the place of one, or if triangles cross
  ClosedSurface(const std::vector<Coordinates>& vertices, const std::vector<Triangle>& triangles);
  ClosedSurface(const ClosedSurface&) = delete;
  ClosedSurface& operator=(const ClosedSurface&) = delete;
  ~ClosedSurface();

  /// True inside, and within `boundary_tolerance` of the surface.
  [[nodiscard]] bool contains(const Coordinates& place) const;
  /// Appends the t at which the line meets a triangle.
  void append_crossings(const Line& line, std::vector<double>& t) const;
  [[nodiscard]] double distance(const Coordinates& place) const;
  [[nodiscard]] const Box& bounds() const { return bounds_; }

 private:
  struct Tree;
  Box bounds_{};
  double slack_ = 0.0;
  std::unique_ptr<Tree> tree_;
};

/// Reads an STL file, ASCII or binary. Equal vertices are one.
/// @param scale, translate  as in StlBody
/// @throws InputError ("file") as ClosedSurface does, and if it can't be read or has no triangles
[[nodiscard]] std::shared_ptr<const ClosedSurface> read_stl(const std::filesystem::path& file,
                                                            double scale,
                                                            const Coordinates& translate);

}  // namespace peristat
