#pragma once

#include <optional>
#include <vector>

#include "solvers/motion/stable_step.hpp"

namespace peristat {

/// What a body in motion has beside its forces. Arrays have an entry per degree of freedom.
struct MotionSetting {
  std::vector<double> mass;                    ///< lumped, positive on every free one [kg]
  std::vector<double> displacement, velocity;  ///< at the start; empty: zeros [m], [m/s]
  /// Rates at which velocities decay by themselves [1/s]; empty: they do not.
  std::vector<double> absorption{};
  /// Of an interaction, or what bounds eigenvalues likewise; 0: sums of rows bound them.
  int most_points = 2;
  std::optional<Stiffness> at_start{};  ///< if it is known already
};

}  // namespace peristat
