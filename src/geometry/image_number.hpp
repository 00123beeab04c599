#pragma once

#include <cstddef>

#include "src/geometry/points.hpp"

namespace peristat {

/// Number, from 1, of the kind of images that a point belongs to; 0: it is no image.
[[nodiscard]] inline Index image_number(const Points& points, Index point) {
  if (!points.is_image(point)) return 0;
  return static_cast<Index>(points.images.kind[std::size_t(point - points.own())]) + 1;
}

}  // namespace peristat
