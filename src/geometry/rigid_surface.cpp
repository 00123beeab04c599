#include "src/geometry/rigid_surface.hpp"

#include <cmath>
#include <limits>

#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

}  // namespace

Coordinates RigidSurface::across(const Coordinates& place) const {
  if (kind != Kind::cylinder) return place;
  return minus(place, scaled(dot(place, direction), direction));
}

Coordinates RigidSurface::lever(const Coordinates& place) const {
  return kind == Kind::plane ? place : minus(place, across(place));
}

double RigidSurface::distance(const Coordinates& place) const {
  if (kind == Kind::plane) return dot(place, direction);
  const double beyond = length(across(place)) - radius;
  return is_hollow ? -beyond : beyond;
}

RigidSurface::Distance RigidSurface::change(const Coordinates& place,
                                            const Coordinates& step) const {
  if (kind == Kind::plane) return {dot(step, direction), direction, 0.0};
  const Coordinates from = across(place), along = across(step), arm = plus(from, along);
  const double rho = length(arm), sum = rho + length(from), sign = is_hollow ? -1.0 : 1.0;
  // On the axis there is no direction; that is deep inside of a solid, and far from a hollow one.
  if (rho == 0.0) return {-sign * sum, {}, 0.0};
  return {sign * (2.0 * dot(from, along) + dot(along, along)) / sum, scaled(sign / rho, arm),
          sign / rho};
}

Tensor RigidSurface::second_derivative(const Distance& at) const {
  Tensor second{};
  if (at.curvature == 0.0) return second;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      double across_axis = r == c ? 1.0 : 0.0;
      if (kind == Kind::cylinder) across_axis -= direction[r] * direction[c];
      second[r][c] = at.curvature * (across_axis - at.gradient[r] * at.gradient[c]);
    }
  }
  return second;
}

double RigidSurface::share_to_level(const Coordinates& place, const Coordinates& step,
                                    double level) const {
  if (kind == Kind::plane) {
    const double gap = dot(place, direction) - level, closing = -dot(step, direction);
    return gap >= 0.0 && closing > 0.0 ? gap / closing : never;
  }
  // |arm + t step|^2 = rho^2 with the level's own radius: a t^2 + 2 b t + c = 0.
  const Coordinates arm = across(place), along = across(step);
  const double rho = is_hollow ? radius - level : radius + level;
  if (rho <= 0.0) return never;
  const double a = dot(along, along), b = dot(arm, along), c = dot(arm, arm) - rho * rho;
  const double discriminant = b * b - a * c;
  if (a == 0.0 || discriminant < 0.0) return never;
  const double root = std::sqrt(discriminant);
  if (is_hollow) return c <= 0.0 ? (b > 0.0 ? -c / (b + root) : (root - b) / a) : never;
  return c >= 0.0 && b < 0.0 ? c / (root - b) : never;
}

std::optional<RigidSurface::Shifts> RigidSurface::shifts_to_level(const Coordinates& place,
                                                                  const Coordinates& axis,
                                                                  double level) const {
  if (kind == Kind::plane) {
    const double gap = dot(place, direction) - level, closing = dot(axis, direction);
    if (closing == 0.0) return std::nullopt;
    return closing > 0.0 ? Shifts{gap / closing, never} : Shifts{-never, gap / closing};
  }
  const Coordinates arm = across(place), along = across(axis);
  const double rho = is_hollow ? radius - level : radius + level, squared = dot(along, along);
  if (squared == 0.0) return std::nullopt;
  const double middle = dot(arm, along) / squared;
  const double aside = length(minus(arm, scaled(middle, along)));
  if (!(aside < rho)) return std::nullopt;
  const double half = std::sqrt((rho - aside) * (rho + aside) / squared);
  return Shifts{middle - half, middle + half};
}

double RigidSurface::share_across(const Coordinates& vector) const {
  if (kind != Kind::cylinder) return 1.0;
  const Coordinates part = across(vector);
  return dot(part, part);
}

double RigidSurface::least_distance_passed(const Coordinates& place,
                                           const Coordinates& step) const {
  if (kind == Kind::plane || is_hollow) return never;
  const Coordinates arm = across(place), along = across(step);
  const double a = dot(along, along), nearest = -dot(arm, along);
  if (!(nearest > 0.0 && nearest < a)) return never;
  return length(plus(arm, scaled(nearest / a, along))) - radius;
}

}  // namespace peristat
