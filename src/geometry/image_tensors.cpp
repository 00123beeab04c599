#include "src/geometry/image_tensors.hpp"

namespace peristat {

void gather_image_tensors(const Points& points, std::vector<double>& tensors) {
  const auto d = std::size_t(points.dimension);
  for (Index image = points.own(); image < points.count(); ++image) {
    const auto& mirror = points.image_kind(image).mirror;
    const double* from = &tensors[std::size_t(image) * d * d];
    double* const to = &tensors[std::size_t(points.source(image)) * d * d];
    for (std::size_t r = 0; r < d; ++r) {
      for (std::size_t c = 0; c < d; ++c) to[r * d + c] += mirror[r] * mirror[c] * from[r * d + c];
    }
  }
}

}  // namespace peristat
