#include "src/geometry/boundary_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
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

  void operator()(const Disk& disk) {
    Piece piece;
    piece.part = {shape, 0};
    piece.radius = disk.radius;
    piece.start = {disk.centre[0], disk.centre[1], 0.0};
    piece.to = whole_turn;
    pieces.push_back(piece);
  }

  void operator()(const Cylinder&) {}  // check_lattice refuses these in 2D
  void operator()(const Sphere&) {}
};

/// Appends the angles at which a circle meets the line of a segment.
void append_angles(const Piece& circle, const Piece& line, std::vector<double>& t) {
  const Coordinates normal = line.normal(0.0);
  const double height = dot(minus(line.start, circle.start), normal) / circle.radius;
  const double middle = std::atan2(normal[1], normal[0]);
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

}  // namespace

Coordinates Piece::at(double t) const {
  if (radius == 0.0) return {start[0] + t * along[0], start[1] + t * along[1], 0.0};
  return {start[0] + radius * std::cos(t), start[1] + radius * std::sin(t), 0.0};
}

Coordinates Piece::normal(double t) const {
  if (radius == 0.0) return {sign * along[1], -sign * along[0], 0.0};
  return {sign * std::cos(t), sign * std::sin(t), 0.0};
}

double Piece::nearest(const Coordinates& place) const {
  const Coordinates arm = minus(place, start);
  if (radius == 0.0) return std::clamp(dot(arm, along), from, to);
  double t = from + std::fmod(std::atan2(arm[1], arm[0]) - from, whole_turn);
  if (t < from) t += whole_turn;
  if (t <= to) return t;
  return t - to < from + whole_turn - t ? to : from;
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
        // Where edges on the same line begin and end, and where a circle may touch it.
        t.push_back(dot(minus(other.start, whole.start), whole.along));
      } else if (other.radius == 0.0) {
        append_angles(whole, other, t);
      } else {
        append_angles_of_circles(whole, other, t);
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
  const double least = 8.0 * nudge_ / (is_arc ? whole.radius : 1.0);
  std::vector<Piece> found;
  double begin = cuts.front();
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    const double end = cuts[k];
    if (end - begin < least) continue;
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
             std::abs(a.radius - b.radius) + length(minus(a.start, b.start)) < 4.0 * nudge_) {
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
    const double middle = side.axis == 0 ? (side.sign > 0 ? 0.0 : std::numbers::pi)
                                         : (side.sign > 0 ? 0.5 : 1.5) * std::numbers::pi;
    double of_piece = -infinity;
    for (const double t : {piece.from, piece.to})
      of_piece = std::max(of_piece, side.sign * piece.at(t)[axis]);
    if (piece.radius > 0.0 &&
        ((middle >= piece.from && middle <= piece.to) || middle + whole_turn <= piece.to))
      of_piece = side.sign * piece.start[axis] + piece.radius;
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
