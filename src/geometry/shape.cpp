#include "src/geometry/shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/closed_surface.hpp"
#include "src/geometry/ellipse.hpp"
#include "src/geometry/pixels.hpp"

namespace peristat {
namespace {

/// Absolute tolerance [m] for a shape of this size whose coordinates have this magnitude; the
/// second part is the coordinates' own round-off, for a small shape far from the origin.
double tolerance(double size, double magnitude) {
  return boundary_tolerance * size + 8 * std::numeric_limits<double>::epsilon() * magnitude;
}

double magnitude(const Coordinates& a) {
  return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
}

// ---- inside ----

bool inside(const Box& box, const Coordinates& place) {
  double size = 0.0, largest = 0.0;
  bool bounded = true;
  for (int c = 0; c < 3; ++c) {
    for (const double bound : {box.min[c], box.max[c]}) {
      if (std::isfinite(bound)) largest = std::max(largest, std::abs(bound));
    }
    const double edge = box.max[c] - box.min[c];
    if (std::isfinite(edge)) size = std::max(size, edge);
    bounded = bounded && std::isfinite(edge);
  }
  // A half-space has no size; the distance of its plane from the origin is used instead.
  if (!bounded) size = std::max(size, largest);
  const double slack = tolerance(size, largest);
  for (int c = 0; c < 3; ++c) {
    if (!(place[c] >= box.min[c] - slack && place[c] <= box.max[c] + slack)) return false;
  }
  return true;
}

bool inside(const Disk& disk, const Coordinates& place) {
  const double distance = std::hypot(place[0] - disk.centre[0], place[1] - disk.centre[1]);
  return distance <= disk.radius + tolerance(disk.radius, magnitude(disk.centre));
}

bool inside(const Cylinder& cylinder, const Coordinates& place) {
  const Coordinates from_centre = minus(place, cylinder.centre);
  const double along = dot(from_centre, cylinder.axis) / length(cylinder.axis);
  Coordinates across = from_centre;
  for (int c = 0; c < 3; ++c) across[c] -= along * cylinder.axis[c] / length(cylinder.axis);
  const double largest = std::max(magnitude(cylinder.centre), magnitude(place));
  return length(across) <= cylinder.radius + tolerance(cylinder.radius, largest) &&
         std::abs(along) <= 0.5 * cylinder.length + tolerance(cylinder.length, largest);
}

bool inside(const Sphere& sphere, const Coordinates& place) {
  return length(minus(place, sphere.centre)) <=
         sphere.radius + tolerance(sphere.radius, magnitude(sphere.centre));
}

/// Even-odd rule; the boundary, where that rule is arbitrary, is found by the distance to the
/// edges.
bool inside(const Polygon& polygon, const Coordinates& place) {
  const Box box = bounds(polygon);
  const double size = std::max(box.max[0] - box.min[0], box.max[1] - box.min[1]);
  const double largest = std::max(
      {std::abs(box.min[0]), std::abs(box.max[0]), std::abs(box.min[1]), std::abs(box.max[1])});
  const double slack = tolerance(size, largest);
  const double x = place[0], y = place[1];
  bool odd = false;
  for (std::size_t i = 0, count = polygon.vertices.size(); i < count; ++i) {
    const auto [ax, ay] = polygon.vertices[i];
    const auto [bx, by] = polygon.vertices[(i + 1) % count];
    const double dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
    const double nearest =
        square > 0 ? std::clamp(((x - ax) * dx + (y - ay) * dy) / square, 0.0, 1.0) : 0.0;
    if (std::hypot(x - ax - nearest * dx, y - ay - nearest * dy) <= slack) return true;
    if ((ay > y) != (by > y) && x < ax + (y - ay) / dy * dx) odd = !odd;
  }
  return odd;
}

/// With rho = |(x / a, y / b)|, the distance outside is (rho - 1) rho / |(x / a^2, y / b^2)| to
/// first order.
bool inside(const Ellipse& ellipse, const Coordinates& place) {
  const auto [a, b, none] = ellipse.radii;
  const auto [x, y, height] = along_axes(ellipse, minus(place, ellipse.centre));
  const double rho = std::hypot(x / a, y / b);
  const double slack = tolerance(std::max(a, b), magnitude(ellipse.centre));
  return rho <= 1.0 || (rho - 1.0) * rho <= slack * std::hypot(x / (a * a), y / (b * b));
}

bool inside(const PixelImage& image, const Coordinates& place) {
  return inside(Box{image.min, image.max}, {place[0], place[1], 0.0}) && is_in_pixel(image, place);
}

bool inside(const StlBody& body, const Coordinates& place) { return body.surface->contains(place); }

// ---- bounding boxes ----

Box box_around(const Box& box) { return box; }

Box box_around(const Disk& disk) {
  const auto [x, y, z] = disk.centre;
  const double r = disk.radius;
  return {{x - r, y - r, -infinity}, {x + r, y + r, infinity}};
}

/// A disk of radius R normal to the unit axis a reaches R sqrt(1 - a_c^2) in direction c, its
/// centre line L/2 |a_c|.
Box box_around(const Cylinder& cylinder) {
  Box box;
  for (int c = 0; c < 3; ++c) {
    const double a = std::abs(cylinder.axis[c]) / length(cylinder.axis);
    const double along = a > 0 ? 0.5 * cylinder.length * a : 0.0;  // not infinity times zero
    const double reach = along + cylinder.radius * std::sqrt(std::max(0.0, 1.0 - a * a));
    box.min[c] = cylinder.centre[c] - reach;
    box.max[c] = cylinder.centre[c] + reach;
  }
  return box;
}

Box box_around(const Sphere& sphere) {
  Box box{sphere.centre, sphere.centre};
  for (int c = 0; c < 3; ++c) {
    box.min[c] -= sphere.radius;
    box.max[c] += sphere.radius;
  }
  return box;
}

Box box_around(const Polygon& polygon) {
  Box box{{infinity, infinity, -infinity}, {-infinity, -infinity, infinity}};
  for (const auto& vertex : polygon.vertices) {
    for (int c = 0; c < 2; ++c) {
      box.min[c] = std::min(box.min[c], vertex[c]);
      box.max[c] = std::max(box.max[c], vertex[c]);
    }
  }
  return box;
}

Box box_around(const Ellipse& ellipse) {
  const auto [c, s, none] = first_axis(ellipse);
  const auto [a, b, depth] = ellipse.radii;
  const double x = std::hypot(a * c, b * s), y = std::hypot(a * s, b * c);
  return {{ellipse.centre[0] - x, ellipse.centre[1] - y, -infinity},
          {ellipse.centre[0] + x, ellipse.centre[1] + y, infinity}};
}

Box box_around(const PixelImage& image) {
  return {{image.min[0], image.min[1], -infinity}, {image.max[0], image.max[1], infinity}};
}

Box box_around(const StlBody& body) { return body.surface->bounds(); }

// ---- checks ----

struct Checker {
  int dimension;
  const std::string& table;
  const std::string& kind_key;

  void kind(const char* name, bool fits, const char* dimensions) const {
    if (fits) return;
    throw InputError(kind_key, name,
                     "the shape " + std::string(name) + " needs dimension " + dimensions +
                         ", but this case has dimension " + std::to_string(dimension));
  }

  void number(const char* key, double value, bool allowed, const char* what) const {
    if (!allowed) throw InputError(table + "." + key, number_text(value), what);
  }

  void finite(const char* key, const Coordinates& value) const {
    for (int c = 0; c < dimension; ++c) {
      number(key, value[c], std::isfinite(value[c]), "must have finite components");
    }
  }

  void radius(double value) const {
    number("radius", value, std::isfinite(value) && value > 0, "must be positive and finite");
  }

  void operator()(const Box& box) const {
    for (int c = 0; c < dimension; ++c) {
      number("min", box.min[c], !std::isnan(box.min[c]), "must be a number");
      number("max", box.max[c], !std::isnan(box.max[c]), "must be a number");
      if (box.min[c] < box.max[c]) continue;
      throw InputError(table + ".max", number_text(box.max[c]),
                       std::string("must be larger than min = ") + number_text(box.min[c]) +
                           " in direction " + "xyz"[c]);
    }
  }

  void operator()(const Disk& disk) const {
    kind("disk", dimension == 2, "2");
    finite("centre", disk.centre);
    radius(disk.radius);
  }

  void operator()(const Cylinder& cylinder) const {
    kind("cylinder", dimension == 3, "3");
    finite("centre", cylinder.centre);
    finite("axis", cylinder.axis);
    const double axis = length(cylinder.axis);
    number("axis", axis, std::isfinite(axis) && axis > 0, "must be a direction, not zero");
    radius(cylinder.radius);
    number("length", cylinder.length, cylinder.length > 0, "must be positive");
  }

  void operator()(const Sphere& sphere) const {
    kind("sphere", dimension == 3, "3");
    finite("centre", sphere.centre);
    radius(sphere.radius);
  }

  void operator()(const Ellipse& ellipse) const {
    kind("ellipse", dimension == 2, "2");
    finite("centre", ellipse.centre);
    const auto [a, b, none] = ellipse.radii;
    for (const double radius : {a, b})
      number("radii", radius, std::isfinite(radius) && radius > 0, "must be positive and finite");
    number("radii", std::min(a, b), std::min(a, b) >= thinnest_ellipse * std::max(a, b),
           "must be at least a millionth of the other radius; a thinner ellipse is a [[crack]]");
    number("angle", ellipse.angle, std::isfinite(ellipse.angle), "must be finite");
  }

  void operator()(const PixelImage& image) const {
    kind("image", dimension == 2, "2");
    finite("min", image.min);
    finite("max", image.max);
    (*this)(Box{image.min, image.max});
    const auto [low, high] = image.grey;
    number("grey", low, std::isfinite(low) && std::isfinite(high) && low <= high,
           "must be two finite numbers, the second not below the first");
    const auto& in = image.pixels->is_inside;
    if (std::find(in.begin(), in.end(), 1) != in.end()) return;
    throw InputError(table + ".grey", "",
                     "no pixel has such a value; the image has values from " +
                         number_text(image.pixels->extremes[0]) + " to " +
                         number_text(image.pixels->extremes[1]));
  }

  void operator()(const StlBody&) const { kind("stl", dimension == 3, "3"); }

  void operator()(const Polygon& polygon) const {
    kind("polygon", dimension >= 2, "2 or 3");
    double twice_area = 0.0, size = 0.0;
    for (std::size_t i = 0, count = polygon.vertices.size(); i < count; ++i) {
      const auto& origin = polygon.vertices[0];
      const auto& a = polygon.vertices[i];
      const auto& b = polygon.vertices[(i + 1) % count];
      for (const double value : a) {
        number("vertices", value, std::isfinite(value), "must have finite components");
      }
      const double ax = a[0] - origin[0], ay = a[1] - origin[1];
      twice_area += ax * (b[1] - origin[1]) - (b[0] - origin[0]) * ay;
      size = std::max({size, std::abs(ax), std::abs(ay)});
    }
    // Vertices on one line leave a round-off area.
    if (polygon.vertices.size() < 3 || std::abs(twice_area) <= boundary_tolerance * size * size) {
      throw InputError(table + ".vertices", "",
                       "a polygon needs at least three vertices, which enclose an area");
    }
  }
};

}  // namespace

void check_shape(const Shape& shape, int dimension, const std::string& table,
                 const std::string& kind_key) {
  std::visit(Checker{dimension, table, kind_key}, shape);
}

std::filesystem::path file_of(const Shape& shape) {
  return std::visit(
      [](const auto& kind) -> std::filesystem::path {
        if constexpr (requires { kind.file; }) return kind.file;
        return {};
      },
      shape);
}

bool contains(const Shape& shape, const Coordinates& place) {
  return std::visit([&](const auto& kind) { return inside(kind, place); }, shape);
}

Box bounds(const Shape& shape) {
  return std::visit([](const auto& kind) { return box_around(kind); }, shape);
}

}  // namespace peristat
