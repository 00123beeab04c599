#pragma once

#include <array>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Corners of a segment (2D) or triangle (3D) of a boundary; the third is unused in 2D.
struct FacetPart {
  std::array<Index, 3> corner{};
};

/// Divides a side of an element into triangles; in 2D it is the segment itself. A quadrilateral is
/// divided from its corner with the smallest number, so that elements on both sides agree.
[[nodiscard]] std::vector<FacetPart> parts_of(const std::vector<Index>& side);

/// Distance of a place from a segment (2D) or triangle (3D) [m].
[[nodiscard]] double distance_from(const Coordinates& place, const std::vector<Coordinates>& part);

/// True if the segment a-b crosses another segment (2D) or a triangle (3D) within both.
[[nodiscard]] bool crosses_inside(const Coordinates& a, const Coordinates& b,
                                  const std::vector<Coordinates>& part);

/// Stretch [begin, end] of a line a + t (b - a), within [0, 1], that lies in a simplex or within a
/// distance outside of its sides; begin > end: none does.
struct Stretch {
  double begin = 0.0, end = 1.0;
};

/// @param corners 3 in 2D, 4 in 3D
[[nodiscard]] Stretch stretch_in(const std::vector<Coordinates>& corners, const Coordinates& a,
                                 const Coordinates& b, double slack);

}  // namespace peristat
