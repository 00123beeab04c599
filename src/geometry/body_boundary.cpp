#include "src/geometry/body_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/geometry/boundary_curves.hpp"
#include "src/geometry/boundary_surfaces.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

constexpr double flatness = 1e-9;  // tolerance of cosines of angles

/// Distance from a boundary at which its two sides are tested: above the tolerance of every shape
/// and the round-off of the body's coordinates, far below the body's size.
double nudge_of(const Box& body, int dimension, const std::vector<ShapeStep>& shapes) {
  double size = 0.0, largest_shape = 0.0, farthest = 0.0;
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
    size = std::max(size, body.max[c] - body.min[c]);
    farthest = std::max({farthest, std::abs(body.min[c]), std::abs(body.max[c])});
    for (const ShapeStep& step : shapes) {
      const Box box = bounds(step.shape);
      for (const double bound : {box.max[c] - box.min[c], box.min[c], box.max[c]})
        if (std::isfinite(bound)) largest_shape = std::max(largest_shape, std::abs(bound));
    }
  }
  return 1e-8 * size + 4.0 * boundary_tolerance * largest_shape +
         64.0 * std::numeric_limits<double>::epsilon() * farthest;
}

}  // namespace

std::string name_of(const ShapeSide& part, const std::vector<ShapeStep>& shapes) {
  const std::string shape = "shape " + std::to_string(part.shape);
  const Shape& kind = shapes.at(part.shape).shape;
  if (std::holds_alternative<Box>(kind))
    return shape + " side " + name(Side{int(part.side / 2), part.side % 2 == 0 ? -1 : 1});
  if (std::holds_alternative<Polygon>(kind)) return shape + " edge " + std::to_string(part.side);
  if (std::holds_alternative<Cylinder>(kind) && part.side > 0)
    return shape + (part.side == 1 ? " lower end" : " upper end");
  return shape;
}

BodyBoundary::BodyBoundary(int dimension, const std::vector<ShapeStep>& shapes,
                           std::vector<Cover> covers, double spacing)
    : solid_(dimension, shapes),
      body_(solid_, std::move(covers), spacing),
      nudge_(nudge_of(solid_.bounds(), dimension, shapes)),
      spacing_(spacing) {
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    if (has_smooth_sides(shapes[k].shape)) continue;
    throw InputError("shapes[" + std::to_string(k) + "].action", "",
                     "this model acts on the faces of the body's boundary, and an image or a "
                     "surface of triangles has none");
  }
  if (dimension == 2) {
    faces_ = std::make_unique<BoundaryCurves>(body_, shapes, solid_.bounds(), nudge_);
  } else if (dimension == 3) {
    faces_ = std::make_unique<BoundarySurfaces>(body_, shapes, solid_.bounds(), nudge_);
  } else {
    throw InputError("dimension", std::to_string(dimension),
                     "faces of a body are for dimensions 2 and 3");
  }
  for (int k = 0; k < 2 * dimension; ++k)
    outermost_[std::size_t(k)] = faces_->outermost({k / 2, k % 2 == 0 ? -1 : 1});
}

BodyBoundary::~BodyBoundary() = default;

std::vector<Foot> BodyBoundary::near(const Coordinates& place, double distance) const {
  std::vector<Foot> all, kept;
  faces_->append_feet(place, distance * (1.0 + 1e-8), all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Foot& a, const Foot& b) { return a.distance < b.distance; });
  const double smooth = std::cos(smooth_angle * std::numbers::pi / 180.0);
  for (const Foot& foot : all) {
    const bool goes_on = std::any_of(kept.begin(), kept.end(), [&](const Foot& nearer) {
      return dot<3>(nearer.normal, foot.normal) > smooth;
    });
    if (!goes_on) kept.push_back(foot);
  }
  return kept;
}

std::vector<Foot> BodyBoundary::above(const Coordinates& place, double distance) const {
  constexpr double round_off = 1e-6;  // of a spacing
  std::vector<Foot> feet = near(place, distance);
  std::erase_if(feet, [&](const Foot& foot) { return foot.depth(place) < -round_off * spacing_; });
  return feet;
}

std::optional<double> BodyBoundary::outermost(const Side& side) const {
  return outermost_[std::size_t(2 * side.axis + (side.sign > 0 ? 1 : 0))];
}

bool BodyBoundary::is_on(const Foot& foot, const Side& side) const {
  const std::optional<double> height = outermost(side);
  return height && foot.normal[std::size_t(side.axis)] * side.sign > 1.0 - flatness &&
         std::abs(foot.at[std::size_t(side.axis)] - *height) <= 8.0 * nudge_;
}

}  // namespace peristat
