#pragma once

#include <optional>
#include <vector>

#include "solvers/motion/stable_step.hpp"

namespace peristat {

/// What a body in motion has beside its forces. Arrays have an entry per degree of freedom.
struct MotionSetting {
  std::vector<double> mass;                    ///< lumped, positive on every free one [kg]
  std::vector<double> displacement, velocity;  ///< at the start [m], [m/s]
  int most_points = 2;                         ///< of an interaction
  std::optional<Stiffness> at_start{};         ///< if it is known already
};

}  // namespace peristat
