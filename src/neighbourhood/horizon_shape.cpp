#include "src/neighbourhood/horizon_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/core/integral.hpp"

namespace peristat {

double norm_of(HorizonShape shape, const Coordinates& vector) {
  const double x = std::abs(vector[0]), y = std::abs(vector[1]), z = std::abs(vector[2]);
  if (shape == HorizonShape::box) return std::max({x, y, z});
  if (shape == HorizonShape::diamond) return x + y + z;
  return std::sqrt(x * x + y * y + z * z);
}

double farthest_of(HorizonShape shape, int dimension) {
  return shape == HorizonShape::box ? std::sqrt(double(dimension)) : 1.0;
}

double mean_of_reach(HorizonShape shape, int dimension, int power) {
  if (shape == HorizonShape::ball || dimension == 1) return 1.0;
  // Over a face of norm 1 the solid angle of an area dA is dA / r^d times its distance from the
  // middle, and norm(n) = 1 / r.
  constexpr double pi = std::numbers::pi;
  const bool is_box = shape == HorizonShape::box;
  const auto of_length = [&](double squared) {
    return std::pow(squared, 0.5 * (power - dimension));
  };
  if (dimension == 2) {
    const double face = integral(
        [&](double t) { return of_length(is_box ? 1.0 + t * t : t * t + (1.0 - t) * (1.0 - t)); },
        0.0, 1.0);
    return (is_box ? 8.0 : 4.0) / (2.0 * pi) * face;
  }
  const double face = integral(
      [&](double x) {
        return integral(
            [&](double y) {
              const double z = is_box ? 1.0 : 1.0 - x - y;
              return of_length(x * x + y * y + z * z);
            },
            0.0, is_box ? 1.0 : 1.0 - x);
      },
      0.0, 1.0);
  return (is_box ? 24.0 : 8.0) / (4.0 * pi) * face;
}

}  // namespace peristat
