#pragma once

#include <memory>
#include <vector>

namespace peristat {

/// Inertia of points in a step of an implicit motion: springs to where inertia alone would take
/// them. Arrays have an entry per degree of freedom; empty: none.
struct InertialSprings {
  std::vector<double> stiffness{};  ///< [N/m]
  std::vector<double> place{};      ///< displacement without stretch of the spring [m]

  friend bool operator==(const InertialSprings&, const InertialSprings&) = default;
};

/// Load-dependent data of the energy, beside displacement and history.
struct Environment {
  /// Per point, 0 at rest: relative elongation that the body around it would have if nothing held
  /// it. Empty: none.
  std::vector<double> eigenstretch{};
  /// Per face of the boundary that pressures act on [Pa]; empty: none.
  std::vector<double> pressure{};
  /// Displacement of the ground below each spring of the foundations, springs x dimension [m].
  /// Empty: none.
  std::vector<double> ground{};
  /// Displacement of obstacles, obstacles x dimension [m], or their force [N]. Empty: none moves.
  std::vector<double> obstacles{};
  InertialSprings inertia{};
  /// Traction on the surface at points, points x dimension [Pa]; empty: surfaces are free.
  std::vector<double> traction{};

  /// True if some forces of the model are those of loads, not of interactions.
  [[nodiscard]] bool has_follower_force() const { return !pressure.empty() || !traction.empty(); }

  friend bool operator==(const Environment&, const Environment&) = default;
};

/// Made once per load point and shared by all states there; null if it would be empty.
using SharedEnvironment = std::shared_ptr<const Environment>;

/// Interpolates linearly between two environments of the same conditions.
[[nodiscard]] SharedEnvironment between(const SharedEnvironment& from, const SharedEnvironment& to,
                                        double share);

}  // namespace peristat
