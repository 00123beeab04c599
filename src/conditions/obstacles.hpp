#pragma once

#include <map>
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
  /// Displacement of all, obstacles x dimension [m].
  /// @throws InputError if it is not finite
  [[nodiscard]] std::vector<double> displacements(std::span<const double> loads) const;

  /// @throws InputError if an obstacle that has not moved is inside the undeformed body.
  /// Collective.
  void refuse_overlap(const Communicator& ranks) const;

  /// Calls visit(Pressed) for every contact with an energy, in the order of the contacts.
  /// @param foreseen see StateView
  template <class Visit>
  void for_each_pressed(std::span<const double> displacement, std::span<const double> foreseen,
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
  /// the old place of its point, one that ends up to where it leaves the new place.
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
  [[nodiscard]] Coordinates moved(std::size_t obstacle, const SharedEnvironment& environment) const;
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
  std::vector<Contact> contacts_;
  std::vector<Coordinates> reference_;  // of the contacts' points, relative to their obstacle [m]
  std::vector<Obstacle> obstacles_;
};

template <class Visit>
void Obstacles::for_each_place(std::span<const double> displacement,
                               const SharedEnvironment& environment, const Visit& visit) const {
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Coordinates of_obstacle = moved(k, environment);
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
void Obstacles::for_each_pressed(std::span<const double> displacement,
                                 std::span<const double> foreseen,
                                 const SharedEnvironment& environment, const Visit& visit) const {
  // A contact at rest counts as touching in spite of round-off.
  constexpr double round_off = 1e-9;
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Obstacle& of = obstacles_[k];
    const Coordinates of_obstacle = moved(k, environment);
    for (std::size_t c = of.first; c < of.last; ++c) {
      const Contact& contact = contacts_[c];
      const auto depth_at = [&](std::span<const double> at) {
        return depth_of(c, of, at, of_obstacle);
      };
      const bool is_foreseen = !foreseen.empty();
      const Depth depth = depth_at(displacement);
      const bool is_closed =
          is_foreseen ? depth_at(foreseen).relative > -round_off : depth.relative > 0.0;
      if (!is_closed) continue;
      visit(Pressed{contact.point, c, of, depth,
                    is_foreseen ? closed_contact(depth.relative) : of.law(depth.relative),
                    of.depth * contact.distance, contact.stiffness, is_foreseen});
    }
  }
}

}  // namespace peristat
