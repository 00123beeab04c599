#include "src/geometry/layer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/geometry/lattice_frame.hpp"
#include "src/geometry/outermost_face.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Depth below a face, in spacings, at which a foot on it is tested: far above round-off.
constexpr double below_face = 1e-3;

}  // namespace

std::optional<double> outermost_face(const Solid& body, const Side& side,
                                     const std::vector<Coordinates>& places, double spacing,
                                     const Communicator& ranks) {
  std::vector<double> heights;
  Coordinates outwards{};
  outwards[side.axis] = side.sign;
  body.append_levels(outwards, heights);
  std::sort(heights.begin(), heights.end(), std::greater<>());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  const auto feet_at = [&](double height) {
    const auto here = std::count_if(places.begin(), places.end(), [&](Coordinates place) {
      place[side.axis] = side.sign * height;
      return body.contains(place);
    });
    return ranks.count_all(here).all;
  };
  for (const double height : heights) {
    const auto near = feet_at(height - below_face * spacing);
    // Half a spacing below a round side many more feet lie in the body, below a flat one about as
    // many.
    if (near > 0 && 2 * near >= feet_at(height - 0.5 * spacing)) return side.sign * height;
  }
  return std::nullopt;
}

std::optional<double> outermost_face(const Solid& body, const Side& side,
                                     const std::vector<Coordinates>& places, double spacing) {
  return outermost_face(body, side, places, spacing, SoleRank());
}

FrontOfFace::FrontOfFace(const Solid& body, const Side& side, double face, double depth,
                         double spacing, std::vector<const FrontOfFace*> others)
    : body_(body),
      side_(side),
      face_(face),
      depth_(depth),
      dimension_(body.dimension()),
      within_(below_face * spacing),
      others_(std::move(others)) {}

Coordinates FrontOfFace::foot(const Coordinates& place) const {
  Coordinates foot = place;
  foot[side_.axis] = face_ - side_.sign * within_;
  return foot;
}

bool FrontOfFace::contains(const Coordinates& place) const {
  const double above = height(place);
  const double slack = grid_tolerance * depth_;
  return above > slack && above <= depth_ + slack && body_.contains(foot(place)) &&
         !body_.contains(place) &&
         std::none_of(others_.begin(), others_.end(),
                      [&](const FrontOfFace* other) { return other->contains(place); });
}

void FrontOfFace::append_crossings(const Line& line, std::vector<double>& t) const {
  for (const double level : {face_, face_ + side_.sign * depth_}) {
    const double at = (level - line.from[side_.axis]) / line.along[side_.axis];
    if (std::isfinite(at)) t.push_back(at);
  }
  Line on_face = line;
  on_face.from = foot(line.from);
  on_face.along[side_.axis] = 0.0;
  body_.append_crossings(on_face, t);
  body_.append_crossings(line, t);
  for (const FrontOfFace* other : others_) other->append_crossings(line, t);
}

void FrontOfFace::append_levels(const Coordinates& direction, std::vector<double>& levels) const {
  body_.append_levels(direction, levels);
  peristat::append_levels(bounds(), dimension_, direction, levels);
  for (const FrontOfFace* other : others_) other->append_levels(direction, levels);
}

bool FrontOfFace::append_planes(std::array<std::vector<double>, 3>& at) const {
  at[side_.axis].insert(at[side_.axis].end(), {face_, face_ + side_.sign * depth_});
  return body_.append_planes(at) &&
         std::all_of(others_.begin(), others_.end(),
                     [&](const FrontOfFace* other) { return other->append_planes(at); });
}

bool FrontOfFace::may_end_near(const Coordinates& place, double distance) const {
  const double above = height(place);
  return std::min(std::abs(above), std::abs(above - depth_)) < distance ||
         body_.may_end_near(foot(place), distance + within_) ||
         body_.may_end_near(place, distance) ||
         std::any_of(others_.begin(), others_.end(), [&](const FrontOfFace* other) {
           return other->may_end_near(place, distance);
         });
}

Box FrontOfFace::bounds() const {
  Box box = body_.bounds();
  box.min[side_.axis] = std::min(face_, face_ + side_.sign * depth_);
  box.max[side_.axis] = std::max(face_, face_ + side_.sign * depth_);
  return box;
}

}  // namespace peristat
