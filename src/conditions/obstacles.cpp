#include "src/conditions/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "src/conditions/points_of_set.hpp"
#include "src/conditions/with_key.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/geometry/point_sizes.hpp"

namespace peristat {
namespace {

void require(bool is_allowed, double value, const std::string& key, const std::string& allowed) {
  if (!is_allowed) throw InputError(key, number_text(value), allowed);
}

/// The surface with a unit direction, as the body's dimension needs it.
RigidSurface checked_surface(RigidSurface surface, int dimension, const std::string& table) {
  using Kind = RigidSurface::Kind;
  const bool is_plane = surface.kind == Kind::plane;
  if (dimension == 1 && !is_plane) {
    throw InputError(table + ".shape", "", "must be \"plane\" in 1D");
  }
  if (dimension == 2 && surface.kind == Kind::sphere) {
    throw InputError(table + ".shape", "sphere", "is for dimension 3; in 2D a cylinder is a disk");
  }
  if (dimension == 2 && surface.kind == Kind::cylinder) surface.direction = {0.0, 0.0, 1.0};
  if (surface.kind == Kind::sphere) return surface;
  const double norm = length(surface.direction);
  if (!(norm > 0.0) || !std::isfinite(norm)) {
    throw InputError(table + (is_plane ? ".normal" : ".axis"), "",
                     "must be a vector that is not zero");
  }
  surface.direction = unit(surface.direction);
  return surface;
}

/// Points that an obstacle may touch and that this rank owns.
std::vector<Index> touchable_points(const Points& points, const std::string& set,
                                    const std::string& key) {
  std::vector<Index> members(std::size_t(points.own()));
  std::iota(members.begin(), members.end(), Index(0));
  if (!set.empty()) members = points_of_set(points, set, key);
  if (points.owned) std::erase_if(members, [&](Index point) { return point >= *points.owned; });
  return members;
}

/// The axis along which a force drives an obstacle; nothing if none does.
std::optional<std::size_t> free_axis_of(const ObstacleSpecification& of,
                                        const RigidSurface& surface, int dimension,
                                        const std::string& table) {
  std::optional<std::size_t> axis;
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
    if (of.displacement[c] != "free") continue;
    const std::string key = indexed(table + ".displacement", c);
    if (of.force.empty()) throw InputError(key, "free", "needs a force that drives the obstacle");
    if (axis) throw InputError(key, "free", "is for one component, along which the force acts");
    axis = c;
  }
  if (!axis) {
    if (of.force.empty()) return axis;
    throw InputError(table + ".force", of.force,
                     "needs a component of displacement that is \"free\", along which it acts");
  }
  if (of.friction > 0.0) {
    throw InputError(table + ".force", of.force, "is not for an obstacle with friction yet");
  }
  Coordinates along{};
  along[*axis] = 1.0;
  const bool is_plane = surface.kind == RigidSurface::Kind::plane;
  const double share =
      is_plane ? std::abs(dot(along, surface.direction)) : std::sqrt(surface.share_across(along));
  constexpr double least = 1e-3;
  if (share < least) {
    throw InputError(table + ".force", of.force,
                     std::string("acts along the ") + (is_plane ? "plane" : "cylinder") +
                         ", so that the body can't bear it; free another component");
  }
  return axis;
}

/// A cylinder or sphere below two spacings presses on single points.
void refuse_small_radius(const RigidSurface& surface, double size, const std::string& table) {
  if (surface.kind == RigidSurface::Kind::plane) return;
  constexpr double least = 2.0;  // spacings
  if (surface.radius >= least * size * (1.0 - 1e-9)) return;
  throw InputError(table + ".radius", number_text(surface.radius),
                   "must be at least two spacings, " + number_text(least * size) +
                       " m here: a smaller obstacle presses on single points, and fits between "
                       "them; take a finer spacing");
}

}  // namespace

Obstacles::Obstacles(const Points& points, const std::vector<ObstacleSpecification>& specifications,
                     const std::vector<std::string>& parameters, const ObstacleSetting& setting,
                     const Communicator& ranks)
    : dimension_(points.dimension), points_(std::size_t(points.count())) {
  for (std::size_t k = 0; k < specifications.size(); ++k) {
    const ObstacleSpecification& of = specifications[k];
    const std::string table = indexed("obstacles", k);
    if (!points.spacing.is_square()) {
      throw InputError(table, "", "needs square or cubic cells: one spacing for all axes");
    }
    require(of.stiffness > 0.0 && of.stiffness < 1e30, of.stiffness, table + ".stiffness",
            "must be positive");
    require(of.depth > 0.0 && of.depth < 1.0, of.depth, table + ".depth",
            "must be between 0 and 1");
    require(of.softness > 0.0 && of.softness < of.depth, of.softness, table + ".softness",
            "must be positive and below depth, " + number_text(of.depth));
    require(of.friction >= 0.0 && of.friction <= 1e3, of.friction, table + ".friction",
            "must be from 0 to 1000");
    require(of.tangential_stiffness > 0.0 && of.tangential_stiffness <= 1e3,
            of.tangential_stiffness, table + ".tangential_stiffness",
            "must be positive and at most 1000");
    Obstacle made{of.name,
                  table,
                  checked_surface(of.surface, dimension_, table),
                  of.depth,
                  ContactLaw{of.softness / of.depth},
                  of.friction,
                  of.tangential_stiffness,
                  contacts_.size(),
                  0,
                  {},
                  {}};
    made.free_axis = free_axis_of(of, made.surface, dimension_, table);
    double largest = 0.0;
    for (const Index point : touchable_points(points, of.set, table + ".set")) {
      // Points of a refined lattice have sizes of their own, as those of a cloud.
      const bool is_alike = points.lattice && points.horizons.empty();
      const double size =
          is_alike ? double(points.spacing) : size_of_point(points, point, setting.cross_section);
      const double distance = 0.5 * size;
      const double area = setting.cross_section * std::pow(size, dimension_ - 1);
      const double modulus = setting.youngs_modulus.at(std::size_t(point));
      reference_.push_back(minus(points.position(point), made.surface.point));
      contacts_.push_back({point, distance, made.surface.distance(reference_.back()) - distance,
                           of.stiffness * modulus * area / distance});
      largest = std::max(largest, size);
    }
    refuse_small_radius(made.surface, ranks.max(largest), table);
    made.last = contacts_.size();
    for (int c = 0; c < dimension_; ++c) {
      const bool is_free = made.free_axis == std::size_t(c);
      const std::string key =
          is_free ? table + ".force" : indexed(table + ".displacement", std::size_t(c));
      made.displacement.push_back(with_key(key, [&] {
        return Expression(is_free ? of.force : of.displacement[std::size_t(c)], 0, points.spacing,
                          parameters, points.columns, functions_of(points.functions));
      }));
    }
    obstacles_.push_back(std::move(made));
  }
}

bool Obstacles::move() const {
  return std::ranges::any_of(obstacles_, [](const Obstacle& of) {
    return of.free_axis || std::ranges::any_of(of.displacement, [](const Expression& along) {
             return along.text() != "0";
           });
  });
}

bool Obstacles::are_driven() const {
  return std::ranges::any_of(obstacles_, [](const Obstacle& of) { return !!of.free_axis; });
}

bool Obstacles::rub() const {
  return std::ranges::any_of(obstacles_, [](const Obstacle& of) { return of.friction > 0.0; });
}

const Obstacles::Obstacle& Obstacles::obstacle_of(std::size_t contact) const {
  return *std::ranges::upper_bound(obstacles_, contact, {}, &Obstacle::last);
}

Coordinates Obstacles::relative_step(std::size_t contact, std::span<const double> displacement,
                                     const SharedEnvironment& environment) const {
  const auto obstacle = std::size_t(&obstacle_of(contact) - obstacles_.data());
  return step(contact, displacement, moved(obstacle, environment));
}

namespace {

/// The slip of a contact; null: it has none.
const Slip* slip_of(const Slips& slips, std::size_t contact) {
  const auto found = std::ranges::lower_bound(slips, contact, {}, &Slip::contact);
  return found == slips.end() || found->contact != contact ? nullptr : &*found;
}

}  // namespace

Obstacles::CommittedSlips Obstacles::committed(std::span<const double> displacement,
                                               const SharedEnvironment& environment,
                                               const Slips& before) const {
  CommittedSlips result;
  Slips kept, fresh;
  for (const Slip& slip : before) {
    const double stiffness = tangential_stiffness(slip.contact);
    if (!(slip.normal_force > 0.0)) {  // nothing is left of a contact that has opened
      result.dissipated += 0.5 * stiffness * dot(slip.elastic, slip.elastic);
      continue;
    }
    const Coordinates step = relative_step(slip.contact, displacement, environment);
    const Coordinates y = slipped(slip, step);
    const double size = length(y);
    const double bearable = obstacle_of(slip.contact).friction * slip.normal_force / stiffness;
    const double share = size > bearable ? bearable / size : 1.0;
    result.dissipated += stiffness * bearable * std::max(0.0, size - bearable);
    kept.push_back({slip.contact, slip.normal_force, slip.normal, scaled(share, y), step});
  }
  for_each_pressed(displacement, {}, environment, [&](const Pressed& contact) {
    if (contact.obstacle.friction == 0.0 || slip_of(kept, contact.contact)) return;
    fresh.push_back({contact.contact,
                     contact.force(),
                     contact.depth.change.gradient,
                     {},
                     relative_step(contact.contact, displacement, environment)});
  });
  std::ranges::merge(kept, fresh, std::back_inserter(result.slips), {}, &Slip::contact,
                     &Slip::contact);
  return result;
}

Slips Obstacles::stuck(std::span<const double> displacement, const SharedEnvironment& environment,
                       const Slips& before) const {
  Slips slips;
  // As a predictor sees them: contacts that touch count, too.
  for_each_pressed(displacement, displacement, environment, [&](const Pressed& contact) {
    if (contact.obstacle.friction == 0.0) return;
    const Slip* const old = slip_of(before, contact.contact);
    Slip now = old ? *old : Slip{};
    now.contact = contact.contact;
    now.normal_force = std::numeric_limits<double>::infinity();
    now.normal = contact.depth.change.gradient;
    if (!old) now.start = relative_step(contact.contact, displacement, environment);
    slips.push_back(now);
  });
  return slips;
}

Obstacles::LaggedSlips Obstacles::lagged(std::span<const double> displacement,
                                         const SharedEnvironment& environment,
                                         std::span<const double> at_start,
                                         const SharedEnvironment& environment_at_start,
                                         const Slips& before) const {
  LaggedSlips result;
  for (const Slip& slip : before) {  // one that has opened may close again within the step
    result.slips.push_back(slip);
    result.slips.back().normal_force = 0.0;
  }
  Slips pressed;
  for_each_pressed(displacement, {}, environment, [&](const Pressed& contact) {
    if (contact.obstacle.friction == 0.0) return;
    const Slip* const old = slip_of(before, contact.contact);
    Slip now = old ? *old : Slip{};
    if (!old) now.start = relative_step(contact.contact, at_start, environment_at_start);
    now.contact = contact.contact;
    now.normal_force = contact.force();
    now.normal = contact.depth.change.gradient;
    result.change =
        std::max(result.change, std::abs(now.normal_force - (old ? old->normal_force : 0.0)));
    result.largest = std::max(result.largest, now.normal_force);
    pressed.push_back(now);
  });
  for (const Slip& slip : before) {
    if (!slip_of(pressed, slip.contact)) {
      result.change = std::max(result.change, slip.normal_force);
    }
  }
  Slips all;
  std::ranges::set_union(pressed, result.slips, std::back_inserter(all), {}, &Slip::contact,
                         &Slip::contact);
  result.slips = std::move(all);
  return result;
}

std::vector<double> Obstacles::displacements(std::span<const double> loads) const {
  std::vector<double> all;
  for (const Obstacle& of : obstacles_) {
    for (std::size_t c = 0; c < of.displacement.size(); ++c) {
      const std::string key =
          of.free_axis == c ? of.table + ".force" : indexed(of.table + ".displacement", c);
      all.push_back(with_key(key, [&] { return of.displacement[c]({}, loads); }));
    }
  }
  return all;
}

Coordinates Obstacles::moved(std::size_t obstacle, const SharedEnvironment& environment) const {
  Coordinates moved{};
  if (!environment || environment->obstacles.empty()) return moved;
  const auto d = std::size_t(dimension_);
  for (std::size_t c = 0; c < d; ++c) {
    if (obstacles_[obstacle].free_axis != c) moved[c] = environment->obstacles[obstacle * d + c];
  }
  return moved;
}

Coordinates Obstacles::step(std::size_t contact, std::span<const double> displacement,
                            const Coordinates& of_obstacle) const {
  Coordinates step{};
  const auto d = std::size_t(dimension_);
  const double* const own = &displacement[std::size_t(contacts_[contact].point) * d];
  for (std::size_t c = 0; c < d; ++c) step[c] = own[c] - of_obstacle[c];
  return step;
}

Coordinates Obstacles::place(std::size_t contact, std::span<const double> displacement,
                             const Coordinates& of_obstacle) const {
  return plus(reference_[contact], step(contact, displacement, of_obstacle));
}

void Obstacles::refuse_overlap(const Communicator& ranks) const {
  constexpr double round_off = 1e-9;  // of half a spacing
  for (const Obstacle& of : obstacles_) {
    double deepest = 0.0;
    for (std::size_t c = of.first; c < of.last; ++c) {
      const double depth = -contacts_[c].gap;
      if (depth > round_off * contacts_[c].distance) deepest = std::max(deepest, depth);
    }
    deepest = ranks.max(deepest);
    if (deepest == 0.0) continue;
    throw InputError(of.table, "",
                     "begins inside the body: it would press " + number_text(deepest) +
                         " m deep. The body reaches half a spacing beyond its points; move the "
                         "obstacle back by this depth or more");
  }
}

void Obstacles::add_force(std::span<const double> displacement,
                          const SharedEnvironment& environment, const Slips& slips, double factor,
                          std::span<double> force) const {
  const auto d = std::size_t(dimension_);
  for_each_rubbing(displacement, environment, slips, [&](const Rubbing& friction) {
    for (std::size_t c = 0; c < d; ++c) {
      force[std::size_t(friction.point) * d + c] += factor * friction.force[c];
    }
  });
  for_each_pressed(displacement, {}, environment, [&](const Pressed& contact) {
    for (std::size_t c = 0; c < d; ++c) {
      force[std::size_t(contact.point) * d + c] +=
          factor * contact.force() * contact.depth.change.gradient[c];
    }
  });
}

std::map<std::string, Obstacles::Action> Obstacles::actions(std::span<const double> displacement,
                                                            const SharedEnvironment& environment,
                                                            const Slips& slips) const {
  std::map<std::string, Action> actions;
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    actions[obstacles_[k].name].displacement = place_at(k, displacement, environment).displacement;
  }
  const auto add = [&](const Obstacle& of, const Coordinates& force) -> Action& {
    Action& action = actions[of.name];
    action.force = plus(action.force, force);
    return action;
  };
  for_each_pressed(displacement, {}, environment, [&](const Pressed& contact) {
    const Coordinates force = scaled(contact.force(), contact.depth.change.gradient);
    Action& action = add(contact.obstacle, force);
    const Coordinates at = place(contact.contact, displacement, action.displacement);
    action.moment = plus(action.moment, cross(contact.obstacle.surface.lever(at), force));
  });
  for_each_rubbing(displacement, environment, slips, [&](const Rubbing& friction) {
    Action& action = add(friction.obstacle, friction.force);
    const Coordinates at = place(friction.contact, displacement, action.displacement);
    action.moment = plus(action.moment, cross(at, friction.force));
  });
  return actions;
}

double Obstacles::work(std::span<const double> from, const SharedEnvironment& under_from,
                       const Slips& slips_from, std::span<const double> to,
                       const SharedEnvironment& under_to, const Slips& slips_to) const {
  double work = 0.0;
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Obstacle& of = obstacles_[k];
    if (of.free_axis) {
      work += work_of_force(k, from, under_from, to, under_to);
      continue;
    }
    const Coordinates start = moved(k, under_from), end = moved(k, under_to);
    const Coordinates motion = minus(end, start);
    if (motion == Coordinates{}) continue;
    for (std::size_t c = of.first; c < of.last; ++c) {
      const auto [change0, before] = depth_of(c, of, from, start);
      const auto [change1, after] = depth_of(c, of, to, end);
      if (!(before > 0.0) && !(after > 0.0)) continue;
      const Coordinates mean = scaled(0.5, plus(scaled(of.law(before).first, change0.gradient),
                                                scaled(of.law(after).first, change1.gradient)));
      double share = 1.0;  // of the motion, during which they touch
      if (!(before > 0.0)) {
        const double met = depth_of(c, of, from, end).relative;
        if (met > 0.0) share = met / (met - before);
      } else if (!(after > 0.0)) {
        const double left = depth_of(c, of, to, start).relative;
        if (left > 0.0) share = left / (left - after);
      }
      work += share * contacts_[c].stiffness * of.depth * contacts_[c].distance * dot(mean, motion);
    }
  }
  const auto add_friction = [&](std::span<const double> at, const SharedEnvironment& environment,
                                const Slips& slips) {
    for_each_rubbing(at, environment, slips, [&](const Rubbing& friction) {
      const auto k = std::size_t(&friction.obstacle - obstacles_.data());
      work += 0.5 * dot(friction.force, minus(moved(k, under_to), moved(k, under_from)));
    });
  };
  add_friction(from, under_from, slips_from);
  add_friction(to, under_to, slips_to);
  return work;
}

}  // namespace peristat
