#include "src/geometry/shape_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "src/core/coordinates.hpp"
#include "src/geometry/closed_surface.hpp"
#include "src/geometry/ellipse.hpp"
#include "src/geometry/pixels.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Roots of square t^2 + 2 half_linear t + constant.
void append_roots(double square, double half_linear, double constant, std::vector<double>& t) {
  if (square <= 0.0) return;  // along the axis: the line stays in or out
  const double discriminant = half_linear * half_linear - square * constant;
  if (discriminant <= 0.0) return;
  // The root without cancellation first, the other one from their product.
  const double sum = -(half_linear + std::copysign(std::sqrt(discriminant), half_linear));
  t.push_back(sum / square);
  if (sum != 0.0) t.push_back(constant / sum);
}

void append_plane(double height, double slope, std::vector<double>& t) {
  const double at = -height / slope;
  if (std::isfinite(at)) t.push_back(at);
}

struct Crossings {
  int dimension;
  const Line& line;
  std::vector<double>& t;

  void operator()(const Box& box) const {
    for (int c = 0; c < dimension; ++c) {
      append_plane(line.from[c] - box.min[c], line.along[c], t);
      append_plane(line.from[c] - box.max[c], line.along[c], t);
    }
  }

  void round(const Coordinates& from, const Coordinates& along, double radius) const {
    append_roots(dot(along, along), dot(from, along), dot(from, from) - radius * radius, t);
  }

  void operator()(const Disk& disk) const {
    round({line.from[0] - disk.centre[0], line.from[1] - disk.centre[1], 0.0},
          {line.along[0], line.along[1], 0.0}, disk.radius);
  }

  void operator()(const Sphere& sphere) const {
    round(minus(line.from, sphere.centre), line.along, sphere.radius);
  }

  void operator()(const Cylinder& cylinder) const {
    const Coordinates axis = scaled(1.0 / length(cylinder.axis), cylinder.axis);
    const Coordinates from = minus(line.from, cylinder.centre);
    const double height = dot(from, axis), slope = dot(line.along, axis);
    round(minus(from, scaled(height, axis)), minus(line.along, scaled(slope, axis)),
          cylinder.radius);
    append_plane(height - 0.5 * cylinder.length, slope, t);
    append_plane(height + 0.5 * cylinder.length, slope, t);
  }

  void operator()(const PixelImage& image) const {
    for (std::size_t c = 0; c < 2; ++c) {
      for (const double border : borders_along(image, c))
        append_plane(line.from[c] - border, line.along[c], t);
    }
  }

  void operator()(const StlBody& body) const { body.surface->append_crossings(line, t); }

  /// The ellipse is the unit circle in coordinates stretched along its axes.
  void operator()(const Ellipse& ellipse) const {
    Coordinates from = along_axes(ellipse, minus(line.from, ellipse.centre));
    Coordinates along = along_axes(ellipse, line.along);
    for (std::size_t c = 0; c < 2; ++c) {
      from[c] /= ellipse.radii[c];
      along[c] /= ellipse.radii[c];
    }
    round(from, along, 1.0);
  }

  void operator()(const Polygon& polygon) const {
    for (std::size_t k = 0; k < polygon.vertices.size(); ++k) {
      const auto& a = polygon.vertices[k];
      const auto& b = polygon.vertices[k + 1 < polygon.vertices.size() ? k + 1 : 0];
      // The signed distances of the edge's ends from the line show whether it passes between them.
      const auto side = [&](const auto& p) {
        return (p[0] - line.from[0]) * line.along[1] - (p[1] - line.from[1]) * line.along[0];
      };
      const double of_a = side(a), of_b = side(b);
      if ((of_a > 0.0) == (of_b > 0.0)) continue;
      const double normal_x = b[1] - a[1], normal_y = a[0] - b[0];
      append_plane((line.from[0] - a[0]) * normal_x + (line.from[1] - a[1]) * normal_y,
                   line.along[0] * normal_x + line.along[1] * normal_y, t);
    }
  }
};

struct Levels {
  int dimension;
  const Coordinates& direction;
  std::vector<double>& levels;

  void around(const Coordinates& centre, double reach) const {
    const double height = dot(centre, direction);
    for (const double level : {height - reach, height + reach})
      if (std::isfinite(level)) levels.push_back(level);
  }

  void operator()(const Box& box) const {
    for (int corner = 0; corner < 1 << dimension; ++corner) {
      double level = 0.0;
      for (int c = 0; c < dimension; ++c) {
        const double at = corner >> c & 1 ? box.max[c] : box.min[c];
        if (direction[c] != 0.0) level += direction[c] * at;
      }
      if (std::isfinite(level)) levels.push_back(level);
    }
  }

  void operator()(const Disk& disk) const { around(disk.centre, disk.radius); }

  void operator()(const Sphere& sphere) const { around(sphere.centre, sphere.radius); }

  void operator()(const Cylinder& cylinder) const {
    const double along = dot(cylinder.axis, direction) / length(cylinder.axis);
    const double across = cylinder.radius * std::sqrt(std::max(0.0, 1.0 - along * along));
    if (along == 0.0) return around(cylinder.centre, across);
    const double half = 0.5 * cylinder.length * std::abs(along);
    around(cylinder.centre, half + across);
    around(cylinder.centre, half - across);
  }

  void operator()(const PixelImage& image) const {
    for (std::size_t c = 0; c < 2; ++c) {
      if (direction[1 - c] != 0.0) continue;
      for (const double border : borders_along(image, c)) levels.push_back(direction[c] * border);
    }
  }

  /// Where it begins and ends along an axis.
  void operator()(const StlBody& body) const { (*this)(body.surface->bounds()); }

  void operator()(const Ellipse& ellipse) const {
    const Coordinates along = along_axes(ellipse, direction);
    around(ellipse.centre, std::hypot(ellipse.radii[0] * along[0], ellipse.radii[1] * along[1]));
  }

  void operator()(const Polygon& polygon) const {
    for (const auto& vertex : polygon.vertices) {
      levels.push_back(direction[0] * vertex[0] + direction[1] * vertex[1]);
    }
  }
};

struct Distance {
  int dimension;
  const Coordinates& place;

  /// The largest of signed distances from surfaces is, outside, no more than the distance from the
  /// shape that they enclose.
  double operator()(const Box& box) const {
    double outside = -std::numeric_limits<double>::infinity();
    for (int c = 0; c < dimension; ++c) {
      outside = std::max({outside, box.min[c] - place[c], place[c] - box.max[c]});
    }
    return std::abs(outside);
  }

  double operator()(const Disk& disk) const {
    return std::abs(std::hypot(place[0] - disk.centre[0], place[1] - disk.centre[1]) - disk.radius);
  }

  double operator()(const Sphere& sphere) const {
    return std::abs(length(minus(place, sphere.centre)) - sphere.radius);
  }

  double operator()(const Cylinder& cylinder) const {
    const Coordinates axis = scaled(1.0 / length(cylinder.axis), cylinder.axis);
    const Coordinates from = minus(place, cylinder.centre);
    const double height = dot(from, axis);
    const double across = length(minus(from, scaled(height, axis)));
    return std::abs(std::max(across - cylinder.radius, std::abs(height) - 0.5 * cylinder.length));
  }

  /// Anywhere in the rectangle a pixel may end.
  double operator()(const PixelImage& image) const {
    double outside = 0.0;
    for (std::size_t c = 0; c < 2; ++c)
      outside = std::max({outside, image.min[c] - place[c], place[c] - image.max[c]});
    return outside;
  }

  double operator()(const StlBody& body) const { return body.surface->distance(place); }

  double operator()(const Ellipse& ellipse) const { return distance_to(ellipse, place); }

  double operator()(const Polygon& polygon) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < polygon.vertices.size(); ++k) {
      const auto& a = polygon.vertices[k];
      const auto& b = polygon.vertices[k + 1 < polygon.vertices.size() ? k + 1 : 0];
      const double dx = b[0] - a[0], dy = b[1] - a[1], x = place[0] - a[0], y = place[1] - a[1];
      const double square = dx * dx + dy * dy;
      const double s = square > 0.0 ? std::clamp((x * dx + y * dy) / square, 0.0, 1.0) : 0.0;
      nearest = std::min(nearest, std::hypot(x - s * dx, y - s * dy));
    }
    return nearest;
  }
};

}  // namespace

void append_crossings(const Shape& shape, int dimension, const Line& line, std::vector<double>& t) {
  std::visit(Crossings{dimension, line, t}, shape);
}

void append_levels(const Shape& shape, int dimension, const Coordinates& direction,
                   std::vector<double>& levels) {
  std::visit(Levels{dimension, direction, levels}, shape);
}

double distance_to_boundary(const Shape& shape, int dimension, const Coordinates& place) {
  return std::visit(Distance{dimension, place}, shape);
}

}  // namespace peristat
