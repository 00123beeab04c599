#pragma once

#include <optional>
#include <vector>

#include "solvers/motion/stable_step.hpp"

namespace peristat {

/// Data of a moving body beside its forces. Arrays have an entry per degree of freedom.
struct MotionSetting {
  std::vector<double> mass;                    ///< lumped, positive on every free one [kg]
  std::vector<double> displacement, velocity;  ///< at the start; empty: zeros [m], [m/s]
  /// Decay rates of velocities in absorbing layers [1/s]; empty: no drag.
  std::vector<double> absorption{};
  /// Points per interaction, or an equivalent factor of the bound of eigenvalues; 0: row sums bound
  /// these.
  int most_points = 2;
  std::optional<Stiffness> at_start{};  ///< if it is known already
};

}  // namespace peristat
