#pragma once

#include <memory>
#include <vector>

namespace peristat {

/// What stands for the inertia of points in a step of an implicit motion: springs to where inertia
/// alone would take them. Arrays have an entry per degree of freedom; empty: none.
struct InertialSprings {
  std::vector<double> stiffness{};  ///< [N/m]
  std::vector<double> place{};      ///< displacement without stretch of the spring [m]

  friend bool operator==(const InertialSprings&, const InertialSprings&) = default;
};

/// What the load makes the energy itself depend on, beside displacement and history.
struct Environment {
  /// Per point, 0 at rest: by how much of its length the body around it would be longer if nothing
  /// held it. Empty: none.
  std::vector<double> eigenstretch{};
  /// Per face of the boundary that pressures act on [Pa]; empty: none.
  std::vector<double> pressure{};
  /// Displacement of the ground below each spring of the foundations, springs x dimension [m].
  /// Empty: none.
  std::vector<double> ground{};
  InertialSprings inertia{};
  /// On the surface at points, points x dimension [Pa]; empty: surfaces are free.
  std::vector<double> traction{};

  /// Whether some forces of the model are those of loads, not of interactions.
  [[nodiscard]] bool has_follower_force() const { return !pressure.empty() || !traction.empty(); }

  friend bool operator==(const Environment&, const Environment&) = default;
};

/// Made once for a load point and shared by all states that are there; null where nothing of it is.
using SharedEnvironment = std::shared_ptr<const Environment>;

/// On the straight way from one to another of the same conditions.
[[nodiscard]] SharedEnvironment between(const SharedEnvironment& from, const SharedEnvironment& to,
                                        double share);

}  // namespace peristat
