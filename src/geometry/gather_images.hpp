#pragma once

#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// Completes sums over the bonds of every point: adds the sum of an image to that of its source,
/// and copies the source's total back to the image.
template <class Sum, class Add>
void gather_images(const Points& points, std::vector<Sum>& sums, const Add& add) {
  for (Index image = points.own(); image < points.count(); ++image) {
    add(sums[std::size_t(points.source(image))], sums[std::size_t(image)]);
  }
  for (Index image = points.own(); image < points.count(); ++image) {
    sums[std::size_t(image)] = sums[std::size_t(points.source(image))];
  }
}

inline void gather_images(const Points& points, std::vector<double>& sums) {
  gather_images(points, sums, [](double& sum, double more) { sum += more; });
}

}  // namespace peristat
