// Obstacles that a force drives: where they are.

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/conditions/obstacles.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Coordinates along_axis(std::size_t axis) {
  Coordinates along{};
  along[axis] = 1.0;
  return along;
}

}  // namespace

double Obstacles::force_on(std::size_t obstacle, const SharedEnvironment& environment) const {
  const auto& axis = obstacles_[obstacle].free_axis;
  if (!axis || !environment || environment->obstacles.empty()) return 0.0;
  return environment->obstacles[obstacle * std::size_t(dimension_) + *axis];
}

Obstacles::Ranges Obstacles::ranges_of(const Obstacle& of, std::span<const double> displacement,
                                       const Coordinates& given) const {
  const Coordinates axis = along_axis(*of.free_axis);
  Ranges ranges{{-infinite, infinite}, {-infinite, infinite}};
  const auto limit = [&](Range& range, std::size_t c, double level) {
    const auto shifts = of.surface.shifts_to_level(place(c, displacement, given), axis, level);
    if (of.surface.is_hollow) {  // within them it is free of the point
      range.first = std::max(range.first, shifts ? shifts->first : infinite);
      range.last = std::min(range.last, shifts ? shifts->last : -infinite);
    } else if (shifts) {
      // It is on the side of the point on which it began.
      const bool is_plane = of.surface.kind == RigidSurface::Kind::plane;
      const Coordinates arm = minus(reference_[c], of.surface.lever(reference_[c]));
      const bool is_ahead = is_plane ? shifts->last == infinite : dot(arm, axis) >= 0.0;
      if (is_ahead) {
        range.last = std::min(range.last, shifts->first);
      } else {
        range.first = std::max(range.first, shifts->last);
      }
    }
  };
  for (std::size_t c = of.first; c < of.last; ++c) {
    const double distance = contacts_[c].distance;
    limit(ranges.untouched, c, distance);
    limit(ranges.allowed, c, (1.0 - of.depth) * distance);
  }
  return ranges;
}

std::vector<std::size_t> Obstacles::within(const Range& range, const Obstacle& of,
                                           std::span<const double> displacement,
                                           const Coordinates& given) const {
  const Coordinates axis = along_axis(*of.free_axis);
  std::vector<std::size_t> contacts;
  for (std::size_t c = of.first; c < of.last; ++c) {
    const auto shifts =
        of.surface.shifts_to_level(place(c, displacement, given), axis, contacts_[c].distance);
    const bool touches = of.surface.is_hollow
                             ? !shifts || range.first < shifts->first || range.last > shifts->last
                             : shifts && shifts->first < range.last && shifts->last > range.first;
    if (touches) contacts.push_back(c);
  }
  return contacts;
}

std::array<double, 2> Obstacles::excess(const Place& at, const Obstacle& of,
                                        std::span<const std::size_t> contacts,
                                        std::span<const double> displacement) const {
  const std::size_t axis = *of.free_axis;
  const double across = of.surface.share_across(along_axis(axis));
  double excess = -at.force, slope = 0.0;
  for (const std::size_t c : contacts) {
    const auto [change, relative] = depth_of(c, of, displacement, at.displacement);
    if (!(relative > 0.0)) continue;
    const ContactLaw::Value law = of.law(relative);
    const double along = change.gradient[axis];
    const double force = contacts_[c].stiffness * of.depth * contacts_[c].distance * law.first;
    excess += force * along;
    slope += contacts_[c].stiffness * law.second * along * along -
             force * change.curvature * (across - along * along);
  }
  return {excess, slope};
}

/// Newton's method, safeguarded by bisection, from the middle between where contacts begin and
/// where the first reaches its largest depth. It begins anew in every state, so that what it finds
/// depends on nothing else.
Obstacles::Place Obstacles::place_under(double force, const Obstacle& of,
                                        std::span<const double> displacement,
                                        const Coordinates& given) const {
  Place at{given, force};
  double& along = at.displacement[*of.free_axis];
  const auto [untouched, allowed] = ranges_of(of, displacement, given);
  const bool is_loose = untouched.first <= untouched.last;
  along = is_loose ? std::clamp(0.0, untouched.first, untouched.last) : 0.0;
  if (is_loose && force == 0.0) {
    at.touches = false;
    return at;
  }
  const bool from_first = is_loose && force > 0.0, from_last = is_loose && force < 0.0;
  double low = from_first ? untouched.last : allowed.first;
  double high = from_last ? untouched.first : allowed.last;
  at.is_borne = low < high && std::isfinite(low) && std::isfinite(high);
  if (!at.is_borne) return at;
  const std::vector<std::size_t> contacts = within({low, high}, of, displacement, given);
  const auto excess_at = [&](double place) {
    along = place;
    return excess(at, of, contacts, displacement);
  };
  // A force below the round-off of the depth is borne where contact begins.
  if (!(excess_at(low)[0] < 0.0)) {
    at.is_borne = from_first;
    return at;
  }
  if (!(excess_at(high)[0] > 0.0)) {
    at.is_borne = from_last;
    return at;
  }
  const double depth = of.depth * contacts_[contacts.front()].distance;
  double last_step = high - low, next = 0.5 * (low + high);
  constexpr int most = 300;  // bisections alone would need a sixth
  for (int k = 0; k < most; ++k) {
    const auto [value, slope] = excess_at(next);
    if (value == 0.0) break;
    (value < 0.0 ? low : high) = next;
    double better = next - value / slope;
    const bool is_within = better > low && better < high;
    if (!is_within || !(std::abs(better - next) < 0.5 * last_step)) better = 0.5 * (low + high);
    last_step = std::abs(better - next);
    const bool is_found =
        last_step <= std::numeric_limits<double>::epsilon() * (std::abs(next) + depth);
    next = better;
    if (is_found) break;
  }
  along = next;
  return at;
}

Obstacles::Place Obstacles::place_at(std::size_t obstacle, std::span<const double> displacement,
                                     const SharedEnvironment& environment) const {
  const Coordinates given = moved(obstacle, environment);
  if (!obstacles_[obstacle].free_axis) return {given};
  return place_under(force_on(obstacle, environment), obstacles_[obstacle], displacement, given);
}

double Obstacles::potential(std::span<const double> displacement,
                            const SharedEnvironment& environment) const {
  double potential = 0.0;
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const auto& axis = obstacles_[k].free_axis;
    const double force = force_on(k, environment);
    if (force != 0.0) {
      potential -= force * place_at(k, displacement, environment).displacement[*axis];
    }
  }
  return potential;
}

SharedEnvironment Obstacles::under_forces_of(const SharedEnvironment& forces,
                                             const SharedEnvironment& places) const {
  if (!are_driven()) return places;
  auto made = std::make_shared<Environment>();
  if (places) made->obstacles = places->obstacles;
  made->obstacles.resize(obstacles_.size() * std::size_t(dimension_), 0.0);
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    if (const auto& axis = obstacles_[k].free_axis) {
      made->obstacles[k * std::size_t(dimension_) + *axis] = force_on(k, forces);
    }
  }
  return made;
}

double Obstacles::foreseen_way(const Obstacle& of, std::span<const double> displacement,
                               const Place& at, std::span<const double> foreseen,
                               const Place& there) const {
  double missing = at.force, stiffness = 0.0;
  for (std::size_t c = of.first; c < of.last; ++c) {
    if (!is_foreseen_closed(c, of, foreseen, there)) continue;
    const auto [change, relative] = depth_of(c, of, displacement, at.displacement);
    const double along = change.gradient[*of.free_axis];
    missing -= contacts_[c].stiffness * of.depth * contacts_[c].distance * relative * along;
    stiffness += contacts_[c].stiffness * along * along;
  }
  return stiffness > 0.0 ? missing / stiffness : 0.0;
}

double Obstacles::work_of_force(std::size_t obstacle, std::span<const double> from,
                                const SharedEnvironment& under_from, std::span<const double> to,
                                const SharedEnvironment& under_to) const {
  const Obstacle& of = obstacles_[obstacle];
  const std::size_t axis = *of.free_axis;
  const Place start = place_at(obstacle, from, under_from), end = place_at(obstacle, to, under_to);
  // Where contact sets in or ends under a force of this sign.
  const auto touch = [&](std::span<const double> at, const SharedEnvironment& under, double sign) {
    const auto [first, last] = ranges_of(of, at, moved(obstacle, under)).untouched;
    return sign > 0.0 ? last : first;
  };
  double work = 0.0;
  if (start.touches && end.touches && start.force * end.force >= 0.0) {
    work = 0.5 * (start.force + end.force) * (end.displacement[axis] - start.displacement[axis]);
  } else {
    if (start.touches && start.force != 0.0) {
      work += 0.5 * start.force * (touch(to, under_to, start.force) - start.displacement[axis]);
    }
    if (end.touches && end.force != 0.0) {
      work += 0.5 * end.force * (end.displacement[axis] - touch(from, under_from, end.force));
    }
  }
  const Coordinates motion = minus(moved(obstacle, under_to), moved(obstacle, under_from));
  if (motion == Coordinates{}) return work;
  const auto add = [&](std::span<const double> at, const Place& place) {
    if (!place.touches) return;
    for (std::size_t c = of.first; c < of.last; ++c) {
      const auto [change, relative] = depth_of(c, of, at, place.displacement);
      const double scale = contacts_[c].stiffness * of.depth * contacts_[c].distance;
      work += 0.5 * scale * of.law(relative).first * dot(change.gradient, motion);
    }
  };
  add(from, start);
  add(to, end);
  return work;
}

void Obstacles::refuse_idle_forces(const SharedEnvironment& environment) const {
  const std::vector<double> rest(points_ * std::size_t(dimension_), 0.0);
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Obstacle& of = obstacles_[k];
    const double force = force_on(k, environment);
    if (force == 0.0) continue;
    const Range allowed = ranges_of(of, rest, moved(k, environment)).allowed;
    if (std::isfinite(force > 0.0 ? allowed.last : allowed.first)) continue;
    throw InputError(of.table + ".force", number_text(force),
                     "drives the obstacle away from the body: no point is in its way");
  }
}

double Obstacles::coupled_pairs() const {
  const std::vector<double> rest(points_ * std::size_t(dimension_), 0.0);
  double pairs = 0.0;
  for (const Obstacle& of : obstacles_) {
    if (!of.free_axis) continue;
    const auto [untouched, allowed] = ranges_of(of, rest, {});
    std::size_t most = 0;
    for (const Range& side :
         {Range{allowed.first, untouched.first}, Range{untouched.last, allowed.last}}) {
      if (side.first < side.last && std::isfinite(side.first) && std::isfinite(side.last)) {
        most = std::max(most, within(side, of, rest, {}).size());
      }
    }
    pairs += 0.5 * double(most) * (double(most) - 1.0);
  }
  return pairs;
}

}  // namespace peristat
