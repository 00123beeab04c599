#include "src/geometry/simplex.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

double distance_from_segment(const Coordinates& place, const Coordinates& p, const Coordinates& q) {
  const Coordinates along = minus(q, p);
  const double t = std::clamp(dot(minus(place, p), along) / dot(along, along), 0.0, 1.0);
  return length(minus(place, plus(p, scaled(t, along))));
}

/// Six times the volume of a tetrahedron; in 2D, with d above the plane, twice the area of abc.
double volume_of(const Coordinates& a, const Coordinates& b, const Coordinates& c,
                 const Coordinates& d) {
  return dot(cross(minus(b, a), minus(c, a)), minus(d, a));
}

double area_of(const Coordinates& a, const Coordinates& b, const Coordinates& c) {
  return cross(minus(b, a), minus(c, a))[2];
}

bool have_other_signs(double a, double b) { return (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0); }

}  // namespace

std::vector<FacetPart> parts_of(const std::vector<Index>& side) {
  if (side.size() == 2) return {{{side[0], side[1], side[1]}}};
  if (side.size() == 3) return {{{side[0], side[1], side[2]}}};
  const auto first = std::size_t(std::min_element(side.begin(), side.end()) - side.begin());
  const auto at = [&](std::size_t k) { return side[(first + k) % 4]; };
  return {{{at(0), at(1), at(2)}}, {{at(0), at(2), at(3)}}};
}

double distance_from(const Coordinates& place, const std::vector<Coordinates>& part) {
  if (part.size() == 2) return distance_from_segment(place, part[0], part[1]);
  const Coordinates normal = cross(minus(part[1], part[0]), minus(part[2], part[0]));
  bool is_above = true;  // the foot is within the triangle
  double nearest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Coordinates &p = part[k], &q = part[(k + 1) % 3];
    if (dot(cross(minus(q, p), minus(place, p)), normal) < 0.0) is_above = false;
    const double here = distance_from_segment(place, p, q);
    nearest = k == 0 ? here : std::min(nearest, here);
  }
  return is_above ? std::abs(dot(minus(place, part[0]), normal)) / length(normal) : nearest;
}

bool crosses_inside(const Coordinates& a, const Coordinates& b,
                    const std::vector<Coordinates>& part) {
  if (part.size() == 2) {
    return have_other_signs(area_of(a, b, part[0]), area_of(a, b, part[1])) &&
           have_other_signs(area_of(part[0], part[1], a), area_of(part[0], part[1], b));
  }
  const auto& [p, q, r] = std::array{part[0], part[1], part[2]};
  if (!have_other_signs(volume_of(p, q, r, a), volume_of(p, q, r, b))) return false;
  const double first = volume_of(a, b, p, q), second = volume_of(a, b, q, r),
               third = volume_of(a, b, r, p);
  return (first > 0.0 && second > 0.0 && third > 0.0) ||
         (first < 0.0 && second < 0.0 && third < 0.0);
}

Stretch stretch_in(const std::vector<Coordinates>& corners, const Coordinates& a,
                   const Coordinates& b, double slack) {
  Stretch within;
  const std::size_t count = corners.size();
  for (std::size_t k = 0; k < count; ++k) {  // the side opposite to corner k
    const Coordinates& p = corners[(k + 1) % count];
    const Coordinates along = minus(corners[(k + 2) % count], p);
    Coordinates normal{-along[1], along[0], 0.0};
    if (count == 4) normal = cross(along, minus(corners[(k + 3) % count], p));
    normal = unit(normal);
    if (dot(normal, minus(corners[k], p)) < 0.0) normal = scaled(-1.0, normal);
    const double height_a = dot(normal, minus(a, p)) + slack;
    const double height_b = dot(normal, minus(b, p)) + slack;
    if (height_a < 0.0 && height_b < 0.0) return {1.0, 0.0};
    if (height_a < 0.0) within.begin = std::max(within.begin, height_a / (height_a - height_b));
    if (height_b < 0.0) within.end = std::min(within.end, height_a / (height_a - height_b));
  }
  return within;
}

}  // namespace peristat
