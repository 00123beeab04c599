#include "assembly/terms/contact/near_faces.hpp"

#include <algorithm>
#include <utility>

#include "assembly/terms/contact/contact_limits.hpp"
#include "assembly/terms/contact/near_pairs.hpp"
#include "assembly/terms/contact/swept_pairs.hpp"
#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

FacetArms moved(const FacetArms& arms, const FacetArms& by, double time) {
  FacetArms later = arms;
  for (std::size_t k = 0; k < 3; ++k) {
    later.moved[k] = plus(arms.moved[k], scaled(time, by.moved[k]));
  }
  return later;
}

}  // namespace

void NearFaces::find_whole(const History& history) {
  if (version_ == history.version()) return;
  version_ = history.version();
  std::vector<char> now = faces_.whole(history);
  if (now != whole_) found_at_.clear();
  whole_ = std::move(now);
}

const FacingPoints& NearFaces::at(std::span<const double> displacement, const History& history) {
  if (faces_.none()) return near_;
  find_whole(history);
  if (room_left(pairs_, found_at_, displacement, threads_) > 0.0) return near_;
  return found_at(displacement, history);
}

const FacingPoints& NearFaces::found_at(std::span<const double> displacement,
                                        const History& history) {
  if (faces_.none()) return near_;
  find_whole(history);
  found_at_.assign(displacement.begin(), displacement.end());
  near_ = faces_.near(displacement, whole_, threads_);
  return near_;
}

double NearFaces::level(const ContactFaces::Meeting& of, double share) const {
  return (1.0 - share * pairs_.rules()[std::size_t(of.rule)].depth) * of.distance;
}

std::vector<ContactFaces::Meeting> NearFaces::meetings(const StateView& at,
                                                       std::span<const double> step) {
  if (faces_.none()) return {};
  find_whole(at.history);
  if (longest_approach(pairs_.points(), step) > pairs_.skin()) {
    return faces_.on_way(at.displacement, step, whole_);
  }
  const double room = room_left(pairs_, found_at_, at.displacement, threads_);
  const FacingPoints& near = longest_approach(pairs_.points(), step) <= room
                                 ? near_
                                 : found_at(at.displacement, at.history);
  std::vector<ContactFaces::Meeting> found;
  for (const FacingPoint& of : near.points) {
    for (const FacingPart& part : near.parts_of(of)) {
      if (part.corners == faces_.corners()) {
        found.push_back({of.point, of.rule, of.distance, part.corner});
      }
    }
  }
  return found;
}

double NearFaces::time_until(const ContactFaces::Meeting& of, const StateView& at,
                             std::span<const double> step, double distance) const {
  // No facet comes nearer faster than the fastest of its corners, so that the time for the rest of
  // the way at this speed is on the safe side [Li et al. 2021, additive continuous collision
  // detection].
  constexpr double near_enough = 1e-3;
  constexpr int most_advances = 1000;
  const FacetArms arms = faces_.arms(of.point, of.corner, faces_.corners(), at.displacement);
  FacetArms by = faces_.arms(of.point, of.corner, faces_.corners(), step);
  double speed = 0.0;
  for (int k = 0; k < faces_.corners(); ++k) {
    speed = std::max(speed, length(by.moved[std::size_t(k)]));
  }
  double time = 0.0, left = facet_distance(arms) - distance;
  if (!(left > 0.0) || !(speed > 0.0)) return never;  // left to the barrier of the law
  for (int advance = 0; advance < most_advances; ++advance) {
    time += left / speed;
    if (time > 1.0) return never;
    left = facet_distance(moved(arms, by, time)) - distance;
    if (left < near_enough * distance) return time;
  }
  return time;
}

double NearFaces::longest_share(const StateView& at, std::span<const double> step) {
  double first = never;
  for (const ContactFaces::Meeting& of : meetings(at, step)) {
    first = std::min(first, time_until(of, at, step, level(of, most_depth_of_step)));
  }
  return first <= 1.0 ? most_time_of_step * first : 1.0;
}

bool NearFaces::passes_through(const StateView& at, std::span<const double> step) {
  return std::ranges::any_of(meetings(at, step), [&](const ContactFaces::Meeting& of) {
    if (time_until(of, at, step, level(of, 1.0)) > 1.0) return false;
    const FacetArms arms = faces_.arms(of.point, of.corner, faces_.corners(), at.displacement),
                    by = faces_.arms(of.point, of.corner, faces_.corners(), step);
    return facet_distance(moved(arms, by, 1.0)) > of.distance;
  });
}

}  // namespace peristat
