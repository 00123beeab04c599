#include "src/geometry/boundary_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/ellipse.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

using Piece = BoundaryCurves::Piece;

constexpr double whole_turn = 2.0 * std::numbers::pi;

Coordinates along_axis(const Side& side, double step) {
  Coordinates result{};
  result[std::size_t(side.axis)] = side.sign * step;
  return result;
}

Piece segment(const ShapeSide& part, const Coordinates& a, const Coordinates& b) {
  Piece piece;
  piece.part = part;
  piece.start = a;
  piece.to = length(minus(b, a));
  piece.along = scaled(1.0 / piece.to, minus(b, a));
  return piece;
}

/// Whole boundaries of shapes, anticlockwise; an unbounded shape ends beyond the body.
struct Curves {
  std::size_t shape;
  const Box& bounds;
  std::vector<Piece> pieces{};

  void polygon(const std::vector<Coordinates>& corners, const std::vector<std::size_t>& sides) {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Coordinates& next = corners[k + 1 < corners.size() ? k + 1 : 0];
      if (corners[k] != next) pieces.push_back(segment({shape, sides[k]}, corners[k], next));
    }
  }

  void operator()(const Box& box) {
    Coordinates low{}, high{};
    for (std::size_t c = 0; c < 2; ++c) {
      const double beyond = bounds.max[c] - bounds.min[c];
      low[c] = std::isfinite(box.min[c]) ? box.min[c] : bounds.min[c] - beyond;
      high[c] = std::isfinite(box.max[c]) ? box.max[c] : bounds.max[c] + beyond;
    }
    polygon({{low[0], low[1], 0.0},
             {high[0], low[1], 0.0},
             {high[0], high[1], 0.0},
             {low[0], high[1], 0.0}},
            {2, 1, 3, 0});
  }

  void operator()(const Polygon& of) {
    double twice_area = 0.0;
    const auto& origin = of.vertices.front();
    for (std::size_t k = 0; k + 1 < of.vertices.size(); ++k) {
      const auto &a = of.vertices[k], &b = of.vertices[k + 1];
      twice_area +=
          (a[0] - origin[0]) * (b[1] - origin[1]) - (b[0] - origin[0]) * (a[1] - origin[1]);
    }
    std::vector<Coordinates> corners;
    std::vector<std::size_t> sides(of.vertices.size());
    for (const auto& vertex : of.vertices) corners.push_back({vertex[0], vertex[1], 0.0});
    std::iota(sides.begin(), sides.end(), std::size_t(0));
    if (twice_area < 0.0) {
      // Backwards, the edge that begins at a corner is the one that ended there.
      std::reverse(corners.begin(), corners.end());
      std::reverse(sides.begin(), sides.end());
      std::rotate(sides.begin(), sides.begin() + 1, sides.end());
    }
    polygon(corners, sides);
  }

  void arc(const Coordinates& centre, const Coordinates& along, double radius,
           double other_radius) {
    Piece piece;
    piece.part = {shape, 0};
    piece.radius = radius;
    piece.other_radius = other_radius;
    piece.start = {centre[0], centre[1], 0.0};
    piece.along = along;
    piece.to = whole_turn;
    pieces.push_back(piece);
  }

  void operator()(const Disk& of) { arc(of.centre, {1.0, 0.0, 0.0}, of.radius, of.radius); }

  void operator()(const Ellipse& of) { arc(of.centre, first_axis(of), of.radii[0], of.radii[1]); }

  void operator()(const Cylinder&) {}  // check_lattice refuses these in 2D
  void operator()(const Sphere&) {}
  void operator()(const StlBody&) {}
  void operator()(const PixelImage&) {}  // BodyBoundary refuses it
};

/// A vector's components along the axes of an arc.
std::array<double, 2> on_axes(const Piece& arc, const Coordinates& vector) {
  return {dot(vector, arc.along), arc.along[0] * vector[1] - arc.along[1] * vector[0]};
}

/// The place of an arc that lies farthest along a direction, and how far from its middle that is.
struct Farthest {
  double t, height;
};

Farthest farthest_along(const Piece& arc, const Coordinates& direction) {
  const auto [x, y] = on_axes(arc, direction);
  const double of_x = arc.radius * x, of_y = arc.other_radius * y;
  return {std::atan2(of_y, of_x), std::hypot(of_x, of_y)};
}

/// Appends the angles at which an arc meets the line of a segment.
void append_angles(const Piece& arc, const Piece& line, std::vector<double>& t) {
  const Coordinates normal = line.normal(0.0);
  const auto [middle, reach] = farthest_along(arc, normal);
  const double height = dot(minus(line.start, arc.start), normal) / reach;
  t.insert(t.end(), {middle, middle + std::numbers::pi});  // where they may touch
  if (std::abs(height) > 1.0) return;
  const double half = std::acos(height);
  t.insert(t.end(), {middle - half, middle + half});
}

/// Appends the angles at which a circle meets another one.
void append_angles_of_circles(const Piece& circle, const Piece& other, std::vector<double>& t) {
  const Coordinates between = minus(other.start, circle.start);
  const double distance = length(between), r = circle.radius, s = other.radius;
  const double cosine = (distance * distance + r * r - s * s) / (2.0 * distance * r);
  const double middle = std::atan2(between[1], between[0]);
  t.insert(t.end(), {middle, middle + std::numbers::pi});  // where they may touch
  if (!(std::abs(cosine) <= 1.0)) return;
  const double half = std::acos(cosine);
  t.insert(t.end(), {middle - half, middle + half});
}

/// Where a function that falls and then rises is least, by golden sections.
template <class Function>
double least_between(const Function& f, double low, double high) {
  constexpr int sections = 80;  // down to round-off
  const double part = 2.0 - std::numbers::phi;
  double a = low + part * (high - low), b = high - part * (high - low);
  double of_a = f(a), of_b = f(b);
  for (int k = 0; k < sections; ++k) {
    if (of_a < of_b) {
      high = b, b = a, of_b = of_a;
      of_a = f(a = low + part * (high - low));
    } else {
      low = a, a = b, of_a = of_b;
      of_b = f(b = high - part * (high - low));
    }
  }
  return 0.5 * (low + high);
}

/// Appends the angles at which an arc may meet an ellipse, or touch it: changes of sign of its
/// height |(x / a, y / b)| - 1 over the ellipse, and extremes of that.
void append_angles_of_ellipse(const Piece& arc, const Piece& ellipse, std::vector<double>& t) {
  constexpr int steps = 256;
  const auto height = [&](double angle) {
    const auto [x, y] = on_axes(ellipse, minus(arc.at(angle), ellipse.start));
    return std::hypot(x / ellipse.radius, y / ellipse.other_radius) - 1.0;
  };
  const auto angle_of = [](int k) { return whole_turn * k / steps; };
  std::vector<double> angles;
  for (int k = 0; k <= steps; ++k) {
    angles.push_back(angle_of(k));
    for (const double sign : {1.0, -1.0}) {
      const auto upwards = [&](double angle) { return sign * height(angle); };
      const double before = angle_of(k - 1), at = angle_of(k), after = angle_of(k + 1);
      if (upwards(at) > upwards(before) || upwards(at) > upwards(after)) continue;
      angles.push_back(least_between(upwards, before, after));
      t.push_back(angles.back());
    }
  }
  std::sort(angles.begin(), angles.end());
  for (std::size_t k = 1; k < angles.size(); ++k) {
    double low = angles[k - 1], high = angles[k];
    const bool is_out = height(low) > 0.0;
    if ((height(high) > 0.0) == is_out) continue;
    for (double at = 0.5 * (low + high); at > low && at < high; at = 0.5 * (low + high))
      ((height(at) > 0.0) == is_out ? low : high) = at;
    t.push_back(high);
  }
}

}  // namespace

Coordinates Piece::at(double t) const {
  const double x = radius == 0.0 ? t : radius * std::cos(t), y = other_radius * std::sin(t);
  return {start[0] + x * along[0] - y * along[1], start[1] + x * along[1] + y * along[0], 0.0};
}

Coordinates Piece::normal(double t) const {
  if (radius == 0.0) return {sign * along[1], -sign * along[0], 0.0};
  const double x = other_radius * std::cos(t), y = radius * std::sin(t);
  return scaled(sign / std::hypot(x, y),
                {x * along[0] - y * along[1], x * along[1] + y * along[0], 0.0});
}

double Piece::speed(double t) const {
  return radius == 0.0 ? 1.0 : std::hypot(radius * std::sin(t), other_radius * std::cos(t));
}

double Piece::nearest(const Coordinates& place) const {
  const Coordinates arm = minus(place, start);
  if (radius == 0.0) return std::clamp(dot(arm, along), from, to);
  const auto [x, y] = on_axes(*this, arm);
  const bool is_circle = radius == other_radius;
  const double anywhere = is_circle ? std::atan2(y, x) : nearest_angle(radius, other_radius, x, y);
  double t = from + std::fmod(anywhere - from, whole_turn);
  if (t < from) t += whole_turn;
  if (t <= to) return t;
  if (is_circle) return t - to < from + whole_turn - t ? to : from;
  // On the rest of an ellipse the distance may have another minimum between the ends.
  constexpr int steps = 64;
  const auto away = [&](double angle) { return length(minus(at(angle), place)); };
  const auto angle_of = [&](int k) { return from + (to - from) * std::clamp(k, 0, steps) / steps; };
  int best = 0;
  for (int k = 1; k <= steps; ++k)
    if (away(angle_of(k)) < away(angle_of(best))) best = k;
  const double inside = least_between(away, angle_of(best - 1), angle_of(best + 1));
  return away(inside) < away(angle_of(best)) ? inside : angle_of(best);
}

BoundaryCurves::BoundaryCurves(const CollaredBody& body, const std::vector<ShapeStep>& shapes,
                               const Box& bounds, double nudge)
    : body_(body), shapes_(shapes), nudge_(nudge) {
  double beyond = 0.0;
  for (const Cover& cover : body.covers()) beyond = std::max(beyond, cover.depth);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    Curves curves{k, bounds};
    std::visit(curves, shapes[k].shape);
    for (Piece& whole : curves.pieces) {
      if (whole.radius == 0.0) {
        whole.from -= beyond;
        whole.to += beyond;
      }
      add_pieces_of(whole);
    }
  }
  check_covers();
  join_faces();
}

/// The sign of the normal out of the body relative to the piece's; 0 where it is no boundary.
double BoundaryCurves::exposure(const Piece& piece, double t) const {
  const Coordinates at = piece.at(t), step = scaled(nudge_, piece.normal(t));
  const bool is_in = body_.contains(minus(at, step));
  const bool goes_on = body_.contains(plus(at, step));
  return double(is_in) - double(goes_on);
}

void BoundaryCurves::append_cuts(const Piece& whole, std::vector<double>& t) const {
  if (whole.radius == 0.0) {
    body_.append_crossings({whole.start, whole.along}, t);
    append_jumps(whole, t);
  }
  const Box nowhere{{-1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}};
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    Curves curves{k, nowhere};
    std::visit(curves, shapes_[k].shape);
    for (const Piece& other : curves.pieces) {
      if (whole.radius == 0.0) {
        // Where edges on the same line begin and end, and where an arc may touch it.
        const double touching =
            other.radius == 0.0 ? 0.0 : farthest_along(other, whole.normal(0.0)).t;
        for (const double angle : {touching, touching + std::numbers::pi})
          if (angle == 0.0 || other.radius > 0.0)
            t.push_back(dot(minus(other.at(angle), whole.start), whole.along));
      } else if (other.radius == 0.0) {
        append_angles(whole, other, t);
      } else if (whole.radius == whole.other_radius && other.radius == other.other_radius) {
        append_angles_of_circles(whole, other, t);
      } else {
        append_angles_of_ellipse(whole, other, t);
      }
    }
  }
  for (const Cover& cover : body_.covers()) {
    if (whole.radius == 0.0) continue;
    Piece line;
    line.along[std::size_t(1 - cover.side.axis)] = 1.0;
    for (const double height : {cover.face, cover.face + cover.side.sign * cover.depth}) {
      line.start[std::size_t(cover.side.axis)] = height;
      append_angles(whole, line, t);
    }
  }
}

/// Appends where on the line the `where` of a cover changes.
void BoundaryCurves::append_jumps(const Piece& whole, std::vector<double>& t) const {
  for (const Cover& cover : body_.covers()) {
    const auto axis = std::size_t(cover.side.axis);
    if (!cover.where || std::abs(whole.along[axis]) > 1e-9 ||
        std::abs(whole.start[axis] - cover.face) > nudge_) {
      continue;
    }
    const auto is_covered = [&](double at) {
      return cover.where(plus(whole.at(at), along_axis(cover.side, nudge_)));
    };
    const double step = 0.25 * body_.spacing();
    for (double low = whole.from; low < whole.to; low += step) {
      double high = std::min(low + step, whole.to), below = low;
      const bool first = is_covered(low);
      if (is_covered(high) == first) continue;
      while (high - below > 0.1 * nudge_) {
        const double middle = 0.5 * (below + high);
        (is_covered(middle) == first ? below : high) = middle;
      }
      t.push_back(high);
    }
  }
}

void BoundaryCurves::add_pieces_of(const Piece& whole) {
  std::vector<double> cuts;
  append_cuts(whole, cuts);
  const bool is_arc = whole.radius > 0.0;
  for (double& t : cuts) {
    if (is_arc) t -= whole_turn * std::floor(t / whole_turn);
  }
  std::erase_if(cuts, [&](double t) { return !(t > whole.from && t < whole.to); });
  cuts.insert(cuts.end(), {whole.from, whole.to});
  std::sort(cuts.begin(), cuts.end());
  // A piece shorter than this has no middle at which its sides can be tested.
  const double least = 8.0 * nudge_;
  std::vector<Piece> found;
  double begin = cuts.front();
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    const double end = cuts[k];
    if ((end - begin) * whole.speed(0.5 * (begin + end)) < least) continue;
    const double sign = exposure(whole, 0.5 * (begin + end));
    if (sign != 0.0 && !found.empty() && found.back().to == begin && found.back().sign == sign) {
      found.back().to = end;
    } else if (sign != 0.0) {
      Piece piece = whole;
      piece.from = begin;
      piece.to = end;
      piece.sign = sign;
      found.push_back(piece);
    }
    begin = end;
  }
  // Joins the parts of an arc on both sides of the angle zero.
  if (is_arc && found.size() > 1 && found.front().from == 0.0 && found.back().to == whole_turn &&
      found.front().sign == found.back().sign) {
    found.back().to += found.front().to;
    found.erase(found.begin());
  }
  pieces_.insert(pieces_.end(), found.begin(), found.end());
}

/// Throws if a side that meets a cover is not perpendicular to it, so that it can't continue
/// straight.
void BoundaryCurves::check_covers() const {
  for (const Piece& piece : pieces_) {
    for (const double t : {piece.from, piece.to}) {
      for (const Cover& cover : body_.covers()) {
        const auto axis = std::size_t(cover.side.axis);
        const Coordinates end = piece.at(t), normal = piece.normal(t);
        if (std::abs(end[axis] - cover.face) > 8.0 * nudge_) continue;
        if (std::abs(normal[axis]) > 1.0 - 1e-6) continue;  // the rest of the side itself
        // Beside the end, in front of the cover.
        Coordinates beside = end;
        const std::size_t across = 1 - axis;
        beside[across] -= std::copysign(1e-2 * body_.spacing(), normal[across]);
        beside[axis] += cover.side.sign * 8.0 * nudge_;
        if (!body_.contains(beside)) continue;
        throw InputError("layers", name(cover.side),
                         "the body's boundary does not meet this side at a right angle, so that it "
                         "can't continue straight beside the layer");
      }
    }
  }
}

bool BoundaryCurves::belong_together(const Piece& a, const Piece& b) const {
  if (a.radius == 0.0 && b.radius == 0.0) {
    const Coordinates of_a = a.normal(0.0), of_b = b.normal(0.0);
    if (length(minus(of_a, of_b)) < 1e-7 &&
        std::abs(dot(minus(b.start, a.start), of_a)) < 4.0 * nudge_)
      return true;
  } else if (a.radius > 0.0 && b.radius > 0.0 && a.sign == b.sign &&
             std::abs(a.radius - b.radius) + std::abs(a.other_radius - b.other_radius) +
                     std::abs(a.radius - a.other_radius) * length(cross(a.along, b.along)) +
                     length(minus(a.start, b.start)) <
                 4.0 * nudge_) {
    return true;
  }
  const double smooth = std::cos(smooth_angle * std::numbers::pi / 180.0);
  for (const double of_a : {a.from, a.to}) {
    for (const double of_b : {b.from, b.to}) {
      if (length(minus(a.at(of_a), b.at(of_b))) < 16.0 * nudge_ &&
          dot(a.normal(of_a), b.normal(of_b)) > smooth)
        return true;
    }
  }
  return false;
}

void BoundaryCurves::join_faces() {
  std::vector<std::size_t> root(pieces_.size());
  std::iota(root.begin(), root.end(), std::size_t(0));
  const auto find = [&](std::size_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  for (std::size_t a = 0; a < pieces_.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b)
      if (belong_together(pieces_[a], pieces_[b])) root[find(a)] = find(b);
  }
  std::vector<std::size_t> number(pieces_.size(), pieces_.size());
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    std::size_t& of_root = number[find(k)];
    if (of_root == pieces_.size()) of_root = faces_++;
    pieces_[k].face = of_root;
  }
}

void BoundaryCurves::append_feet(const Coordinates& place, double distance,
                                 std::vector<Foot>& feet) const {
  std::vector<Foot> nearest(faces_);
  for (Foot& foot : nearest) foot.distance = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces_) {
    const double t = piece.nearest(place);
    const Coordinates at = piece.at(t);
    const double away = length(minus(at, place));
    if (away > distance || away >= nearest[piece.face].distance) continue;
    nearest[piece.face] = {piece.part, at, piece.normal(t), away};
  }
  for (const Foot& foot : nearest)
    if (foot.distance <= distance) feet.push_back(foot);
}

std::optional<double> BoundaryCurves::outermost(const Side& side) const {
  const auto axis = std::size_t(side.axis);
  double farthest = -infinity, flat = -infinity;
  for (const Piece& piece : pieces_) {
    double of_piece = -infinity;
    for (const double t : {piece.from, piece.to})
      of_piece = std::max(of_piece, side.sign * piece.at(t)[axis]);
    const auto [t, height] = farthest_along(piece, along_axis(side, 1.0));
    for (const double turned : {t, t + whole_turn, t + 2.0 * whole_turn})
      if (piece.radius > 0.0 && turned >= piece.from && turned <= piece.to)
        of_piece = side.sign * piece.start[axis] + height;
    farthest = std::max(farthest, of_piece);
    if (piece.radius == 0.0 && piece.normal(0.0)[axis] * side.sign > 1.0 - 1e-9)
      flat = std::max(flat, of_piece);
  }
  // Sides beside a cover continue beyond the body.
  for (const Cover& cover : body_.covers())
    if (cover.side == side) farthest = std::min(farthest, side.sign * cover.face);
  if (flat < farthest - 8.0 * nudge_ || flat == -infinity) return std::nullopt;
  return side.sign * flat;
}

}  // namespace peristat
