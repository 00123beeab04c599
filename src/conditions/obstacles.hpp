#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/conditions/environment.hpp"
#include "src/conditions/slip.hpp"
#include "src/conditions/specification.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/expression.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"
#include "src/potentials/contact_law.hpp"

namespace peristat {

/// Data of the points that obstacles press on.
struct ObstacleSetting {
  double cross_section = 0.0;            ///< h in 2D [m], the area in 1D [m2], 1 in 3D
  std::vector<double> youngs_modulus{};  ///< E per point [Pa]
};

/// Rigid obstacles that press on points. A body's surface is half a spacing d = Delta/2 in front of
/// its outermost points. A point at the signed distance phi from an obstacle has the relative depth
/// x = (d - phi) / (a d), and the energy
///
///   k (a d)^2 b(x),  k = alpha E A / d,  A = h Delta (2D), Delta^2 (3D), the area (1D),
///
/// b of ContactLaw. The force on the point is k a d b' along n = grad phi. Delta is the spacing of
/// a lattice, elsewhere the point's own size.
///
/// Friction is Coulomb's, with an elastic slip e by which contacts stick without creep. With the
/// displacement X of the point relative to the obstacle, P = I - n n^T, and lambda, n, e, X0 of its
/// Slip,
///
///   y = e + P (X - X0),   k_t = beta k,   R = mu lambda / k_t,
///   D = k_t |y|^2 / 2 if |y| <= R, otherwise mu lambda (|y| - R / 2)
///
/// is an incremental potential: a search holds lambda and n, and takes them anew until they are
/// those of the state. Then e becomes y min(1, R / |y|), D keeps k_t |e|^2 / 2, and
/// mu lambda (|y| - R) is dissipated.
///
/// An obstacle that a force F drives has no mass. Its displacement o along an axis e is that at
/// which the points bear the force,
///
///   sum k a d b' (n.e) = F,
///
/// a function of their displacements u. Forces on points are then the derivative of E(u, o(u)) -
/// F o(u), and with the blocks B_i of d2E/du2 the second derivative is
///
///   B_i delta_ij - (B_i e) (B_j e)^T / sum e.B e.
class Obstacles {
 public:
  /// A point that an obstacle may touch.
  struct Contact {
    Index point = 0;
    double distance = 0.0;   ///< d [m]
    double gap = 0.0;        ///< phi - d before anything moves [m]
    double stiffness = 0.0;  ///< k [N/m]
  };
  struct Obstacle {
    std::string name, table;
    RigidSurface surface;
    double depth = 0.0;  ///< a
    ContactLaw law;
    double friction = 0.0;            ///< mu
    double tangential = 0.0;          ///< beta
    std::size_t first = 0, last = 0;  ///< of its contacts
    std::vector<Expression> displacement{};
    /// Axis along which a force drives it: its `displacement` there is this force [N].
    std::optional<std::size_t> free_axis{};
  };
  /// Where an obstacle is at a state.
  struct Place {
    Coordinates displacement{};  ///< [m]
    double force = 0.0;          ///< that drives it [N]
    bool touches = true;         ///< false: it has no force, and gives way to the body
    bool is_borne = true;        ///< false: nowhere do the points bear its force
  };
  /// Of the forces that drive obstacles at a state.
  struct Driving {
    double round_off = 0.0;  ///< of their potential [J]
    bool is_borne = true;    ///< see Place
  };
  /// A contact in a state.
  struct Depth {
    RigidSurface::Distance change;  ///< of the distance since the start
    double relative = 0.0;          ///< x
  };
  /// A contact that has an energy.
  struct Pressed {
    Index point = 0;
    std::size_t contact = 0;
    const Obstacle& obstacle;
    Depth depth;
    ContactLaw::Value law;
    double scale = 0.0;      ///< a d [m]
    double stiffness = 0.0;  ///< k [N/m]
    bool is_foreseen = false;

    [[nodiscard]] double energy() const { return stiffness * scale * scale * law.value; }
    [[nodiscard]] double force() const { return stiffness * scale * law.first; }  ///< along n
  };

  /// Friction of a contact.
  struct Rubbing {
    Index point = 0;
    std::size_t contact = 0;
    const Obstacle& obstacle;
    Coordinates force{};  ///< on the point, -dD/dX [N]
    double energy = 0.0;  ///< D [J]
    /// d2D/dX2 = stiffness (P - sliding y y^T / |y|^2)
    double stiffness = 0.0;             ///< [N/m]
    double sliding = 0.0;               ///< 1 if it slides, otherwise 0
    Coordinates normal{}, direction{};  ///< n, y / |y|
  };
  /// Slips at the end of a step.
  struct CommittedSlips {
    Slips slips;
    double dissipated = 0.0;  ///< [J]
  };
  /// Slips with the normal forces of a state.
  struct LaggedSlips {
    Slips slips;
    double change = 0.0;   ///< largest change of a normal force [N]; infinite after `stuck`
    double largest = 0.0;  ///< largest normal force [N]
  };

  Obstacles() = default;

  /// @param ranks that have parts of the body: collective, each rank has the contacts of its own
  ///        points
  /// @throws InputError ("obstacles[k].…", k from 0) for a bad surface, number or expression, and
  ///         for cells that are no squares or cubes
  Obstacles(const Points& points, const std::vector<ObstacleSpecification>& specifications,
            const std::vector<std::string>& parameters, const ObstacleSetting& setting,
            const Communicator& ranks);

  [[nodiscard]] bool none() const { return obstacles_.empty(); }
  [[nodiscard]] std::span<const Obstacle> all() const { return obstacles_; }
  [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }

  [[nodiscard]] bool move() const;
  /// True if any has friction.
  [[nodiscard]] bool rub() const;
  /// True if forces drive some.
  [[nodiscard]] bool are_driven() const;
  /// Displacement of all, obstacles x dimension [m]; along a free axis the force [N].
  /// @throws InputError if it is not finite
  [[nodiscard]] std::vector<double> displacements(std::span<const double> loads) const;

  /// @throws InputError if an obstacle that has not moved is inside the undeformed body.
  /// Collective.
  void refuse_overlap(const Communicator& ranks) const;

  /// @throws InputError if nothing of the undeformed body is in the way of a force.
  void refuse_idle_forces(const SharedEnvironment& environment) const;

  /// Place of an obstacle. Along a free axis it depends on nothing but the state; without a force
  /// it is at the start, or where the body pushes it.
  [[nodiscard]] Place place_at(std::size_t obstacle, std::span<const double> displacement,
                               const SharedEnvironment& environment) const;
  /// Potential of the forces that drive obstacles, - sum F o [J]: forces on points are the
  /// derivative of the contacts' energy and this.
  [[nodiscard]] double potential(std::span<const double> displacement,
                                 const SharedEnvironment& environment) const;
  /// Environment with the places of one and the forces on obstacles of another.
  [[nodiscard]] SharedEnvironment under_forces_of(const SharedEnvironment& forces,
                                                  const SharedEnvironment& places) const;
  /// Pairs of points that a force couples where its obstacle begins to touch the undeformed body.
  [[nodiscard]] double coupled_pairs() const;

  /// Calls visit(Pressed) for every contact with an energy, in the order of the contacts.
  /// @param foreseen see StateView: obstacles that forces drive are where its springs bear them
  template <class Visit>
  Driving for_each_pressed(std::span<const double> displacement, std::span<const double> foreseen,
                           const SharedEnvironment& environment, const Visit& visit) const;

  /// Calls visit(number of the contact, obstacle, place of its point relative to the obstacle) for
  /// every contact.
  template <class Visit>
  void for_each_place(std::span<const double> displacement, const SharedEnvironment& environment,
                      const Visit& visit) const;

  /// Calls visit(Rubbing) for every contact whose friction has an energy.
  template <class Visit>
  void for_each_rubbing(std::span<const double> displacement, const SharedEnvironment& environment,
                        const Slips& slips, const Visit& visit) const;

  /// Slips that a state leaves behind it.
  [[nodiscard]] CommittedSlips committed(std::span<const double> displacement,
                                         const SharedEnvironment& environment,
                                         const Slips& before) const;
  /// Slips of a search that begins in a state: contacts that touch stick, whatever their force.
  [[nodiscard]] Slips stuck(std::span<const double> displacement,
                            const SharedEnvironment& environment, const Slips& before) const;
  /// Slips before with the normal forces and directions of a state; contacts that are new begin
  /// where they were at the start of the step.
  [[nodiscard]] LaggedSlips lagged(std::span<const double> displacement,
                                   const SharedEnvironment& environment,
                                   std::span<const double> at_start,
                                   const SharedEnvironment& environment_at_start,
                                   const Slips& before) const;

  /// Adds factor * the forces on the points [N].
  void add_force(std::span<const double> displacement, const SharedEnvironment& environment,
                 const Slips& slips, double factor, std::span<double> force) const;

  /// Of an obstacle: its force on the body [N], the moment of this about the obstacle's `point`,
  /// which has moved with it [N m], and its displacement [m].
  struct Action {
    Coordinates force{}, moment{}, displacement{};
  };
  [[nodiscard]] std::map<std::string, Action> actions(std::span<const double> displacement,
                                                      const SharedEnvironment& environment,
                                                      const Slips& slips) const;

  /// Work that the obstacles do on the body from one state to another [J]: the mean of the forces
  /// before and after, times the motion. A contact that sets in works from where the obstacle meets
  /// the old place of its point, one that ends up to where it leaves the new place. That of a force
  /// is the mean of the force times the motion while it touches.
  [[nodiscard]] double work(std::span<const double> from, const SharedEnvironment& under_from,
                            const Slips& slips_from, std::span<const double> to,
                            const SharedEnvironment& under_to, const Slips& slips_to) const;

 private:
  [[nodiscard]] const Obstacle& obstacle_of(std::size_t contact) const;
  /// k_t [N/m]
  [[nodiscard]] double tangential_stiffness(std::size_t contact) const {
    return obstacle_of(contact).tangential * contacts_[contact].stiffness;
  }
  /// Displacement of a contact's point relative to its obstacle [m].
  [[nodiscard]] Coordinates relative_step(std::size_t contact, std::span<const double> displacement,
                                          const SharedEnvironment& environment) const;
  [[nodiscard]] Depth depth_of(std::size_t contact, const Obstacle& of,
                               std::span<const double> displacement,
                               const Coordinates& of_obstacle) const {
    const auto change =
        of.surface.change(reference_[contact], step(contact, displacement, of_obstacle));
    const Contact& at = contacts_[contact];
    return {change, -(at.gap + change.value) / (of.depth * at.distance)};
  }
  /// Displacement that is given, 0 along a free axis [m].
  [[nodiscard]] Coordinates moved(std::size_t obstacle, const SharedEnvironment& environment) const;
  /// Force along the free axis [N].
  [[nodiscard]] double force_on(std::size_t obstacle, const SharedEnvironment& environment) const;

  /// Places on a free axis [m]: where no point touches, and where none is too deep. Empty if the
  /// first is above the second.
  struct Range {
    double first, last;
  };
  struct Ranges {
    Range untouched, allowed;
  };
  [[nodiscard]] Ranges ranges_of(const Obstacle& of, std::span<const double> displacement,
                                 const Coordinates& given) const;
  [[nodiscard]] Place place_under(double force, const Obstacle& of,
                                  std::span<const double> displacement,
                                  const Coordinates& given) const;
  /// Contacts that touch somewhere in a range.
  [[nodiscard]] std::vector<std::size_t> within(const Range& range, const Obstacle& of,
                                                std::span<const double> displacement,
                                                const Coordinates& given) const;
  /// Force of contacts on the points along the free axis less the force [N], and its slope [N/m].
  [[nodiscard]] std::array<double, 2> excess(const Place& at, const Obstacle& of,
                                             std::span<const std::size_t> contacts,
                                             std::span<const double> displacement) const;
  /// How much farther an obstacle goes until the springs that are foreseen bear its force [m].
  [[nodiscard]] double foreseen_way(const Obstacle& of, std::span<const double> displacement,
                                    const Place& at, std::span<const double> foreseen,
                                    const Place& there) const;
  [[nodiscard]] bool is_foreseen_closed(std::size_t contact, const Obstacle& of,
                                        std::span<const double> foreseen,
                                        const Place& there) const {
    constexpr double round_off = 1e-9;  // a contact at rest counts as touching
    return depth_of(contact, of, foreseen, there.displacement).relative > -round_off;
  }
  [[nodiscard]] double work_of_force(std::size_t obstacle, std::span<const double> from,
                                     const SharedEnvironment& under_from,
                                     std::span<const double> to,
                                     const SharedEnvironment& under_to) const;

  /// y of a slip [m].
  [[nodiscard]] static Coordinates slipped(const Slip& slip, const Coordinates& step) {
    const Coordinates moved = minus(step, slip.start);
    return plus(slip.elastic, minus(moved, scaled(dot(moved, slip.normal), slip.normal)));
  }
  /// Displacement of a contact's point relative to its obstacle.
  [[nodiscard]] Coordinates step(std::size_t contact, std::span<const double> displacement,
                                 const Coordinates& of_obstacle) const;
  [[nodiscard]] Coordinates place(std::size_t contact, std::span<const double> displacement,
                                  const Coordinates& of_obstacle) const;

  int dimension_ = 0;
  std::size_t points_ = 0;
  std::vector<Contact> contacts_;
  std::vector<Coordinates> reference_;  // of the contacts' points, relative to their obstacle [m]
  std::vector<Obstacle> obstacles_;
};

template <class Visit>
void Obstacles::for_each_place(std::span<const double> displacement,
                               const SharedEnvironment& environment, const Visit& visit) const {
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Coordinates of_obstacle = place_at(k, displacement, environment).displacement;
    for (std::size_t c = obstacles_[k].first; c < obstacles_[k].last; ++c) {
      visit(c, obstacles_[k], place(c, displacement, of_obstacle));
    }
  }
}

template <class Visit>
void Obstacles::for_each_rubbing(std::span<const double> displacement,
                                 const SharedEnvironment& environment, const Slips& slips,
                                 const Visit& visit) const {
  for (const Slip& slip : slips) {
    const Obstacle& of = obstacle_of(slip.contact);
    const double limit = of.friction * slip.normal_force;
    if (!(limit > 0.0)) continue;
    const Coordinates y = slipped(slip, relative_step(slip.contact, displacement, environment));
    const double size = length(y), stiffness = tangential_stiffness(slip.contact);
    const double bearable = limit / stiffness;
    const bool slides = size > bearable;
    const Coordinates direction = size > 0.0 ? scaled(1.0 / size, y) : Coordinates{};
    visit(Rubbing{contacts_[slip.contact].point, slip.contact, of,
                  scaled(-(slides ? limit : stiffness * size), direction),
                  slides ? limit * (size - 0.5 * bearable) : 0.5 * stiffness * size * size,
                  slides ? limit / size : stiffness, slides ? 1.0 : 0.0, slip.normal, direction});
  }
}

template <class Visit>
Obstacles::Driving Obstacles::for_each_pressed(std::span<const double> displacement,
                                               std::span<const double> foreseen,
                                               const SharedEnvironment& environment,
                                               const Visit& visit) const {
  const bool is_foreseen = !foreseen.empty();
  Driving driving;
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Obstacle& of = obstacles_[k];
    const Place at = place_at(k, displacement, environment);
    driving.is_borne &= at.is_borne;
    if (!at.touches) continue;
    const Place there = is_foreseen ? place_at(k, foreseen, environment) : at;
    double further = 0.0;
    if (of.free_axis) {
      if (is_foreseen) further = foreseen_way(of, displacement, at, foreseen, there);
      driving.round_off += std::numeric_limits<double>::epsilon() *
                           std::abs(at.force * at.displacement[*of.free_axis]);
    }
    for (std::size_t c = of.first; c < of.last; ++c) {
      const Contact& contact = contacts_[c];
      const double scale = of.depth * contact.distance;
      Depth depth = depth_of(c, of, displacement, at.displacement);
      const bool is_closed =
          is_foreseen ? is_foreseen_closed(c, of, foreseen, there) : depth.relative > 0.0;
      if (!is_closed) continue;
      if (further != 0.0) depth.relative += depth.change.gradient[*of.free_axis] * further / scale;
      visit(Pressed{contact.point, c, of, depth,
                    is_foreseen ? closed_contact(depth.relative) : of.law(depth.relative), scale,
                    contact.stiffness, is_foreseen});
    }
  }
  return driving;
}

}  // namespace peristat
