#include "src/geometry/box_in_ball.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <boost/math/quadrature/gauss.hpp>

namespace peristat {
namespace {

/// Fraction of a box's volume: a smaller part counts as none, and all but this as the whole box.
constexpr double round_off = 1e-12;

PlaneVector operator-(const PlaneVector& a, const PlaneVector& b) {
  return {a[0] - b[0], a[1] - b[1]};
}
double plane_cross(const PlaneVector& a, const PlaneVector& b) { return a[0] * b[1] - a[1] * b[0]; }
double plane_dot(const PlaneVector& a, const PlaneVector& b) { return a[0] * b[0] + a[1] * b[1]; }

struct Segment {
  PlaneVector from, to;
};

/// The part of a side in the disk.
std::optional<Segment> chord(const PlaneVector& from, const PlaneVector& to, double radius) {
  const PlaneVector along = to - from;
  const double squared = plane_dot(along, along), half = plane_dot(from, along);
  const double root = half * half - squared * (plane_dot(from, from) - radius * radius);
  if (!(root > 0.0)) return {};
  const double enter = std::max((-half - std::sqrt(root)) / squared, 0.0);
  const double leave = std::min((-half + std::sqrt(root)) / squared, 1.0);
  if (!(enter < leave)) return {};
  const auto at = [&](double t) {
    return PlaneVector{from[0] + t * along[0], from[1] + t * along[1]};
  };
  return Segment{enter == 0.0 ? from : at(enter), leave == 1.0 ? to : at(leave)};
}

/// Sums of area and moment about a corner of the part, so that they keep their digits.
class Sums {
 public:
  explicit Sums(const PlaneVector& about) : about_(about) {}

  /// Adds the triangle of the corner and a side.
  void add_triangle(const PlaneVector& from, const PlaneVector& to) {
    const PlaneVector a = from - about_, b = to - about_;
    const double area = 0.5 * plane_cross(a, b);
    area_ += area;
    for (std::size_t c = 0; c < 2; ++c) moment_[c] += area * (a[c] + b[c]) / 3.0;
  }

  /// Adds the region between the chord and the circle, anticlockwise.
  void add_segment(const PlaneVector& from, const PlaneVector& to, double radius) {
    const PlaneVector along = to - from;
    const double length = std::hypot(along[0], along[1]);
    if (length == 0.0) return;
    // Half of theta, by the chord's half length and its distance from the centre.
    const double half = std::atan2(0.5 * length, plane_cross(from, to) / length);
    const double area = 0.5 * radius * radius * (2.0 * half - std::sin(2.0 * half));
    const PlaneVector bisector{along[1] / length, -along[0] / length};
    const double moment = length * length * length / 12.0;
    area_ += area;
    for (std::size_t c = 0; c < 2; ++c) moment_[c] += moment * bisector[c] - area * about_[c];
  }

  [[nodiscard]] PolygonPart about_origin() const {
    return {area_, {moment_[0] + area_ * about_[0], moment_[1] + area_ * about_[1]}};
  }

 private:
  PlaneVector about_;
  double area_ = 0.0;
  PlaneVector moment_{};
};

bool holds_origin(const std::vector<PlaneVector>& corners) {
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (plane_cross(corners[k], corners[(k + 1) % corners.size()]) <= 0.0) return false;
  }
  return true;
}

/// A box's rectangle across one of its axes: lower and upper corner.
struct Rectangle {
  PlaneVector lower, upper;

  [[nodiscard]] std::vector<PlaneVector> corners() const {
    return {lower, {upper[0], lower[1]}, upper, {lower[0], upper[1]}};
  }
};

PolygonPart rectangle_in_disk(const Rectangle& of, double squared_radius) {
  return squared_radius > 0.0 ? polygon_in_disk(of.corners(), std::sqrt(squared_radius))
                              : PolygonPart();
}

/// Squares of the radii at which a disk meets a side or a corner.
std::vector<double> squared_kinks(const Rectangle& of) {
  std::vector<double> squared;
  for (const double x : {of.lower[0], of.upper[0]}) {
    for (const double y : {of.lower[1], of.upper[1]}) squared.push_back(x * x + y * y);
  }
  for (std::size_t c = 0; c < 2; ++c) {
    if (of.lower[1 - c] > 0.0 || of.upper[1 - c] < 0.0) continue;
    for (const double side : {of.lower[c], of.upper[c]}) squared.push_back(side * side);
  }
  squared.push_back(0.0);
  return squared;
}

/// Integral of the areas of a box's sections in a ball between two heights without a kink between
/// them. At a kink areas grow like its distance to the power of one or three halves: with z =
/// middle - half cos(t) they are smooth, except for kinks just beyond the ends, whose effect
/// halving confines.
double volume_between(const Rectangle& across, double from, double to, double radius,
                      int halvings) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  const auto of_angle = [&](double t) {
    const double z = middle - half * std::cos(t);
    return half * std::sin(t) * rectangle_in_disk(across, radius * radius - z * z).area;
  };
  using boost::math::quadrature::gauss;
  const double fine = gauss<double, 30>::integrate(of_angle, 0.0, std::numbers::pi);
  const double coarse = gauss<double, 15>::integrate(of_angle, 0.0, std::numbers::pi);
  const PlaneVector edges = across.upper - across.lower;
  const double most = 2.0 * half * edges[0] * edges[1];
  if (halvings == 0 || std::abs(fine - coarse) <= 1e-12 * most) return fine;
  return volume_between(across, from, middle, radius, halvings - 1) +
         volume_between(across, middle, to, radius, halvings - 1);
}

/// Volume of the part of a box in a ball, by sections across the last axis.
double sections(const Rectangle& across, double from, double to, double radius) {
  std::vector<double> heights{from, to};
  for (const double squared : squared_kinks(across)) {
    const double height = std::sqrt(std::max(radius * radius - squared, 0.0));
    for (const double at : {-height, height}) {
      if (at > from && at < to) heights.push_back(at);
    }
  }
  std::ranges::sort(heights);
  constexpr int most_halvings = 10;
  double volume = 0.0;
  for (std::size_t k = 1; k < heights.size(); ++k) {
    volume += volume_between(across, heights[k - 1], heights[k], radius, most_halvings);
  }
  return volume;
}

/// int x dV of the part of a box in a ball, from the areas and moments of its
/// faces in the ball.
Coordinates moment_of_box(const Coordinates& lower, const Coordinates& upper, double radius) {
  Coordinates of_faces{}, of_sphere{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    const Rectangle face{{lower[a], lower[b]}, {upper[a], upper[b]}};
    for (const bool is_upper : {false, true}) {
      const double at = is_upper ? upper[axis] : lower[axis], sign = is_upper ? 1.0 : -1.0;
      const PolygonPart part = rectangle_in_disk(face, radius * radius - at * at);
      of_faces[axis] += sign * at * at * part.area;
      of_faces[a] += sign * at * part.moment[0];
      of_faces[b] += sign * at * part.moment[1];
      of_sphere[axis] -= radius * radius * sign * part.area;
    }
  }
  Coordinates moment;
  for (std::size_t c = 0; c < 3; ++c) moment[c] = 0.25 * (of_faces[c] + of_sphere[c]);
  return moment;
}

/// Distances of a box's nearest and farthest place from the origin.
std::array<double, 2> range_of(const Coordinates& lower, const Coordinates& upper) {
  std::array<double, 2> squared{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double nearest = std::clamp(0.0, lower[c], upper[c]);
    const double farthest = std::max(std::abs(lower[c]), std::abs(upper[c]));
    squared[0] += nearest * nearest;
    squared[1] += farthest * farthest;
  }
  return {std::sqrt(squared[0]), std::sqrt(squared[1])};
}

}  // namespace

PolygonPart polygon_in_disk(const std::vector<PlaneVector>& corners, double radius) {
  std::vector<Segment> chords;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto inside = chord(corners[k], corners[(k + 1) % corners.size()], radius);
    if (inside) chords.push_back(*inside);
  }
  if (chords.empty()) {
    return holds_origin(corners) ? PolygonPart{std::numbers::pi * radius * radius, {}}
                                 : PolygonPart();
  }
  Sums sums(chords.front().from);
  for (std::size_t k = 0; k < chords.size(); ++k) {
    const PlaneVector& exit = chords[k].to;
    const PlaneVector& entry = chords[(k + 1) % chords.size()].from;
    sums.add_triangle(chords[k].from, exit);
    sums.add_triangle(exit, entry);
    if (exit != entry) sums.add_segment(exit, entry, radius);
  }
  return sums.about_origin();
}

BoxPart box_in_ball(const Coordinates& centre, const Coordinates& edges, double radius,
                    int dimension) {
  Coordinates lower{}, upper{};
  double size = 1.0;
  for (int c = 0; c < dimension; ++c) {
    lower[c] = centre[c] - 0.5 * edges[c];
    upper[c] = centre[c] + 0.5 * edges[c];
    size *= edges[c];
  }
  const auto [nearest, farthest] = range_of(lower, upper);
  if (farthest <= radius) return {1.0, centre};
  if (nearest >= radius) return {};

  double volume = 0.0;
  Coordinates moment{};
  if (dimension == 1) {
    const double from = std::max(lower[0], -radius), to = std::min(upper[0], radius);
    volume = to - from;
    moment[0] = 0.5 * (from + to) * volume;
  } else {
    const Rectangle across{{lower[0], lower[1]}, {upper[0], upper[1]}};
    if (dimension == 2) {
      const PolygonPart part = rectangle_in_disk(across, radius * radius);
      volume = part.area;
      moment = {part.moment[0], part.moment[1], 0.0};
    } else {
      volume = sections(across, lower[2], upper[2], radius);
      moment = moment_of_box(lower, upper, radius);
    }
  }
  if (volume >= size * (1.0 - round_off)) return {1.0, centre};
  if (!(volume > size * round_off)) return {};
  for (double& component : moment) component /= volume;
  return {volume / size, moment};
}

}  // namespace peristat
