#pragma once

#include <cstddef>

#include "src/geometry/points.hpp"

namespace peristat {

/// Which kind of images a point is of, from 1; 0: it stands for itself.
[[nodiscard]] inline Index image_number(const Points& points, Index point) {
  if (!points.is_image(point)) return 0;
  return static_cast<Index>(points.images.kind[std::size_t(point - points.own())]) + 1;
}

}  // namespace peristat
