#include "src/geometry/ellipse.hpp"

#include <cmath>
#include <numbers>

#include "src/core/coordinates.hpp"

namespace peristat {

Coordinates first_axis(const Ellipse& ellipse) {
  const double angle = ellipse.angle * std::numbers::pi / 180.0;
  return {std::cos(angle), std::sin(angle), 0.0};
}

Coordinates along_axes(const Ellipse& ellipse, const Coordinates& vector) {
  const auto [c, s, none] = first_axis(ellipse);
  return {c * vector[0] + s * vector[1], c * vector[1] - s * vector[0], none};
}

double nearest_angle(double a, double b, double x, double y) {
  const double p = std::abs(x), q = std::abs(y);
  // The derivative of half the squared distance is -b q <= 0 at 0 and a p >= 0 at pi/2, and has one
  // change of sign between.
  double low = 0.0, high = 0.5 * std::numbers::pi;
  for (double t = 0.5 * high; t > low && t < high; t = 0.5 * (low + high)) {
    const double slope =
        a * p * std::sin(t) - b * q * std::cos(t) - (a - b) * (a + b) * std::sin(t) * std::cos(t);
    (slope < 0.0 ? low : high) = t;
  }
  const double t = 0.5 * (low + high);
  return std::atan2(std::copysign(std::sin(t), y), std::copysign(std::cos(t), x));
}

double distance_to(const Ellipse& ellipse, const Coordinates& place) {
  const auto [a, b, none] = ellipse.radii;
  const auto [x, y, height] = along_axes(ellipse, minus(place, ellipse.centre));
  const double t = nearest_angle(a, b, x, y);
  return std::hypot(x - a * std::cos(t), y - b * std::sin(t));
}

}  // namespace peristat
