#pragma once

#include <optional>

#include "src/core/types.hpp"

namespace peristat {

/// Surface of a rigid body: a plane, a cylinder (in 2D a circle) or a sphere. Places are relative
/// to its own `point`.
struct RigidSurface {
  enum class Kind { plane, cylinder, sphere };

  Kind kind = Kind::plane;
  Coordinates point{};      ///< on the plane or the axis, or the centre [m]
  Coordinates direction{};  ///< unit vector: normal of the plane, or axis of the cylinder
  double radius = 0.0;      ///< [m]
  bool is_hollow = false;   ///< what it presses on is within the cylinder or sphere

  /// Signed distance phi of a place, positive outside of the rigid body, with its derivatives:
  /// x.n for a plane, else rho - R, of a hollow one R - rho, where rho = |P x| and P x leaves out
  /// the part along a cylinder's axis.
  struct Distance {
    double value = 0.0;      ///< phi, or its change [m]
    Coordinates gradient{};  ///< a unit vector, towards the free side
    double curvature = 0.0;  ///< of the surface through the place, positive if convex [1/m]
  };
  [[nodiscard]] double distance(const Coordinates& place) const;
  /// The same at `place` + `step`, but as the change of phi from the place on, which has round-off
  /// of the step alone: n.v, or +-(2 x.v + v.v) / (rho + rho_0) across the axis.
  [[nodiscard]] Distance change(const Coordinates& place, const Coordinates& step) const;

  /// Second derivative of phi, curvature (P - n n^T) with the gradient n [1/m].
  [[nodiscard]] Tensor second_derivative(const Distance& at) const;

  /// Least share t >= 0 of a step at which phi(place + t step) has fallen to a level below its
  /// present value; infinite if it never does.
  [[nodiscard]] double share_to_level(const Coordinates& place, const Coordinates& step,
                                      double level) const;

  /// Shifts t of the surface along a unit vector, from `first` to `last`, for which
  /// phi(place - t axis) is below a level; of a hollow surface those for which it is not. Infinite
  /// if there is no end, nothing if there are none.
  struct Shifts {
    double first = 0.0, last = 0.0;
  };
  [[nodiscard]] std::optional<Shifts> shifts_to_level(const Coordinates& place,
                                                      const Coordinates& axis, double level) const;

  /// Square of the part of a unit vector along which the distance can change: 1 for a plane and a
  /// sphere, 1 - (axis.v)^2 for a cylinder.
  [[nodiscard]] double share_across(const Coordinates& vector) const;

  /// Least phi on the straight way of a step, if the place comes nearer at first and withdraws at
  /// the end; otherwise infinite. Planes have no far side.
  [[nodiscard]] double least_distance_passed(const Coordinates& place,
                                             const Coordinates& step) const;

  /// Part of a place that gives its forces a moment about `point`: on a plane all of it, along a
  /// cylinder's axis, and none on a sphere.
  [[nodiscard]] Coordinates lever(const Coordinates& place) const;

 private:
  /// Part across a cylinder's axis.
  [[nodiscard]] Coordinates across(const Coordinates& place) const;
};

}  // namespace peristat
