#include "src/geometry/boundary_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/core/coordinates.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

using Surface = BoundarySurfaces::Surface;
using Kind = Surface::Kind;

/// A unit vector perpendicular to `axis`.
Coordinates across(const Coordinates& axis) {
  std::size_t least = 0;
  for (std::size_t c = 1; c < 3; ++c)
    if (std::abs(axis[c]) < std::abs(axis[least])) least = c;
  Coordinates other{};
  other[least] = 1.0;
  return unit(cross(axis, other));
}

/// Surfaces of a shape.
struct Surfaces {
  std::size_t shape;
  const ShapeStep& step;
  double beyond;  // how far covers reach beyond the shape [m]
  std::vector<Surface>& surfaces;

  Surface& next(Kind kind, std::size_t side) {
    Surface& surface = surfaces.emplace_back();
    surface.kind = kind;
    surface.part = {shape, side};
    surface.sign = step.action == ShapeStep::Action::add ? 1.0 : -1.0;
    surface.bounds = bounds(step.shape);
    for (std::size_t c = 0; c < 3; ++c) {
      surface.bounds.min[c] -= beyond;
      surface.bounds.max[c] += beyond;
    }
    return surface;
  }

  Surface& plane(std::size_t side, const Coordinates& at, const Coordinates& normal) {
    Surface& surface = next(Kind::plane, side);
    surface.middle = at;
    surface.axis = normal;
    return surface;
  }

  void round(Kind kind, const Coordinates& middle, const Coordinates& axis, double radius) {
    Surface& surface = next(kind, 0);
    surface.middle = middle;
    surface.axis = axis;
    surface.radius = radius;
  }

  void operator()(const Box& box) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (const bool upper : {false, true}) {
        Coordinates at{}, normal{};
        at[c] = upper ? box.max[c] : box.min[c];
        normal[c] = upper ? 1.0 : -1.0;
        if (!std::isfinite(at[c])) continue;
        Surface& surface = plane(2 * c + (upper ? 1 : 0), at, normal);
        surface.bounds.min[c] = surface.bounds.max[c] = at[c];
      }
    }
  }

  void operator()(const Polygon& of) {
    double twice_area = 0.0;
    const auto count = of.vertices.size();
    for (std::size_t k = 0; k < count; ++k) {
      const auto &o = of.vertices[0], &a = of.vertices[k], &b = of.vertices[(k + 1) % count];
      twice_area += (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const auto &a = of.vertices[k], &b = of.vertices[(k + 1) % count];
      if (a == b) continue;
      const double turn = twice_area > 0.0 ? 1.0 : -1.0;
      plane(k, {a[0], a[1], 0.0}, unit({turn * (b[1] - a[1]), -turn * (b[0] - a[0]), 0.0}));
    }
  }

  void operator()(const Cylinder& of) {
    const Coordinates axis = unit(of.axis);
    round(Kind::cylinder, of.centre, axis, of.radius);
    if (!std::isfinite(of.length)) return;
    const Coordinates half = scaled(0.5 * of.length, axis);
    plane(1, minus(of.centre, half), scaled(-1.0, axis));
    plane(2, plus(of.centre, half), axis);
  }

  void operator()(const Sphere& of) { round(Kind::sphere, of.centre, {}, of.radius); }

  void operator()(const Disk&) {}  // check_lattice refuses these in 3D
  void operator()(const Ellipse&) {}
  void operator()(const PixelImage&) {}
  void operator()(const StlBody&) {}  // BodyBoundary refuses it
};

/// True if both are the same places with the body on the same side.
bool are_one(const Surface& a, const Surface& b, double slack) {
  if (a.kind != b.kind || std::abs(a.radius - b.radius) > slack) return false;
  const double facing = a.kind == Kind::plane ? dot(a.axis, b.axis) : 1.0;
  if (a.sign * b.sign * facing < 0.0) return false;
  const Coordinates between = minus(b.middle, a.middle);
  if (a.kind == Kind::sphere) return length(between) < slack;
  if (length(cross(a.axis, b.axis)) > 1e-7) return false;
  const double along = dot(between, a.axis);
  if (a.kind == Kind::plane) return std::abs(along) < slack;
  return length(minus(between, scaled(along, a.axis))) < slack;
}

double distance_to(const Box& box, const Coordinates& place) {
  double squared = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    squared += std::pow(std::max({0.0, box.min[c] - place[c], place[c] - box.max[c]}), 2);
  return std::sqrt(squared);
}

}  // namespace

Coordinates Surface::normal(const Coordinates& at) const {
  if (kind == Kind::plane) return axis;
  Coordinates arm = minus(at, middle);
  if (kind == Kind::cylinder) arm = minus(arm, scaled(dot(arm, axis), axis));
  if (length(arm) > 1e-12 * radius) return unit(arm);
  // From the middle all directions are equivalent.
  return kind == Kind::cylinder ? across(axis) : Coordinates{1.0, 0.0, 0.0};
}

Coordinates Surface::foot(const Coordinates& place) const {
  const Coordinates out = normal(place);
  const double height = dot(minus(place, middle), out) - radius;
  return minus(place, scaled(height, out));
}

std::array<Coordinates, 2> Surface::tangents(const Coordinates& at) const {
  const Coordinates out = normal(at);
  const Coordinates first = kind == Kind::cylinder ? axis : across(out);
  return {first, cross(out, first)};
}

Coordinates Surface::reached(const Coordinates& from, const Coordinates& direction,
                             double way) const {
  if (kind == Kind::plane) return plus(from, scaled(way, direction));
  const Coordinates out = normal(from);
  const double along = kind == Kind::cylinder ? dot(direction, axis) : 0.0;
  const Coordinates round = minus(direction, scaled(along, axis));
  const double speed = length(round);
  Coordinates at = plus(from, scaled(way * along, axis));
  if (speed < 1e-12) return at;
  const double angle = way * speed / radius;
  at = plus(at, scaled(radius * (std::cos(angle) - 1.0), out));
  return plus(at, scaled(radius * std::sin(angle) / speed, round));
}

BoundarySurfaces::BoundarySurfaces(const CollaredBody& body, const std::vector<ShapeStep>& shapes,
                                   const Box& bounds, double nudge)
    : body_(body), bounds_(bounds), nudge_(nudge) {
  double beyond = 0.0;
  for (const Cover& cover : body.covers()) beyond = std::max(beyond, cover.depth);
  std::vector<Surface> all;
  for (std::size_t k = 0; k < shapes.size(); ++k)
    std::visit(Surfaces{k, shapes[k], beyond, all}, shapes[k].shape);
  for (const Surface& surface : all) {
    const auto known = std::find_if(surfaces_.begin(), surfaces_.end(), [&](const Surface& one) {
      return are_one(one, surface, 4.0 * nudge_);
    });
    if (known == surfaces_.end()) {
      surfaces_.push_back(surface);
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      known->bounds.min[c] = std::min(known->bounds.min[c], surface.bounds.min[c]);
      known->bounds.max[c] = std::max(known->bounds.max[c], surface.bounds.max[c]);
    }
  }
}

bool BoundarySurfaces::is_exposed(const Surface& surface, const Coordinates& at) const {
  const Coordinates step = scaled(surface.sign * nudge_, surface.normal(at));
  return body_.contains(minus(at, step)) && !body_.contains(plus(at, step));
}

std::optional<Coordinates> BoundarySurfaces::first_exposed(const Surface& surface,
                                                           const Coordinates& place,
                                                           double distance,
                                                           const Coordinates& direction,
                                                           double most) const {
  constexpr int steps = 32;
  const Coordinates from = surface.foot(place);
  double before = 0.0;
  for (int step = 1; step <= steps; ++step) {
    double way = most * step / steps;
    Coordinates at = surface.reached(from, direction, way);
    if (!is_exposed(surface, at)) {
      if (length(minus(at, place)) > distance) return std::nullopt;  // and farther from here on
      before = way;
      continue;
    }
    while (way - before > 1e-3 * nudge_) {
      const double middle = 0.5 * (before + way);
      if (middle <= before || middle >= way) break;
      const Coordinates between = surface.reached(from, direction, middle);
      if (is_exposed(surface, between)) {
        way = middle;
        at = between;
      } else {
        before = middle;
      }
    }
    if (length(minus(at, place)) > distance) return std::nullopt;
    return at;
  }
  return std::nullopt;
}

std::optional<Coordinates> BoundarySurfaces::nearest(const Surface& surface,
                                                     const Coordinates& place,
                                                     double distance) const {
  const Coordinates foot = surface.foot(place);
  const double height = length(minus(foot, place));
  if (height > distance) return std::nullopt;
  if (is_exposed(surface, foot)) return foot;
  // The foot is cut off: searches the surface from it in all directions, each for its nearest
  // exposed part.
  double most = 2.0 * distance;
  if (surface.kind == Kind::plane)
    most = std::sqrt(std::max(0.0, distance * distance - height * height)) * (1.0 + 1e-9);
  else
    most = std::min(0.5 * std::numbers::pi * most, std::numbers::pi * surface.radius);
  const std::array<Coordinates, 2> tangents = surface.tangents(foot);
  std::optional<Coordinates> best;
  double least = distance, best_angle = 0.0;
  const auto try_angle = [&](double angle) {
    const Coordinates direction =
        plus(scaled(std::cos(angle), tangents[0]), scaled(std::sin(angle), tangents[1]));
    const auto at = first_exposed(surface, place, least, direction, most);
    if (!at) return;
    best = at;
    best_angle = angle;
    least = length(minus(*at, place));
  };
  constexpr int angles = 64;
  constexpr double between = 2.0 * std::numbers::pi / angles;
  for (int k = 0; k < angles; ++k) try_angle(between * k);
  for (double width = 0.5 * between; width > 1e-7 && best; width *= 0.5) {
    const double middle = best_angle;
    try_angle(middle - width);
    try_angle(middle + width);
  }
  return best;
}

void BoundarySurfaces::append_feet(const Coordinates& place, double distance,
                                   std::vector<Foot>& feet) const {
  for (const Surface& surface : surfaces_) {
    if (distance_to(surface.bounds, place) > distance) continue;
    const auto at = nearest(surface, place, distance);
    if (!at) continue;
    feet.push_back(
        {surface.part, *at, scaled(surface.sign, surface.normal(*at)), length(minus(*at, place))});
  }
}

std::optional<double> BoundarySurfaces::outermost(const Side& side) const {
  const auto axis = std::size_t(side.axis);
  const double height = side.sign > 0 ? bounds_.max[axis] : bounds_.min[axis];
  for (const Surface& surface : surfaces_) {
    if (surface.kind != Kind::plane || side.sign * surface.sign * surface.axis[axis] < 1.0 - 1e-9 ||
        std::abs(surface.middle[axis] - height) > 8.0 * nudge_) {
      continue;
    }
    // An exposed part of the plane as wide as 1/64 of the body is found.
    constexpr int parts = 64;
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    Coordinates at = surface.middle;
    for (int k = 0; k < parts * parts; ++k) {
      at[u] = bounds_.min[u] + (bounds_.max[u] - bounds_.min[u]) * (k % parts + 0.5) / parts;
      at[v] = bounds_.min[v] + (bounds_.max[v] - bounds_.min[v]) * (k / parts + 0.5) / parts;
      if (is_exposed(surface, at)) return height;
    }
  }
  return std::nullopt;
}

}  // namespace peristat
