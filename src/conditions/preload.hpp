#pragma once

#include <string>

#include "src/conditions/conditions.hpp"
#include "src/core/types.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Actions on a body at load 0, before its loading programme begins. Sizes are the largest over the
/// body.
struct Preload {
  double displacement = 0.0;  ///< of supports and handles [m]
  Coordinates force{};        ///< sum of the loads [N]
  double force_size = 0.0;    ///< sum of their absolute components [N]
  double eigenstretch = 0.0;  ///< of temperatures and eigenstrains [1]
  double pressure = 0.0;      ///< on faces [Pa]
  double traction = 0.0;      ///< on the surface [Pa]
  double ground = 0.0;        ///< displacement below foundations [m]
  double obstacles = 0.0;     ///< displacement of obstacles [m]
  double on_obstacles = 0.0;  ///< forces that drive obstacles [N]

  [[nodiscard]] bool acts() const;
  /// "loads of 12 N (in sum 0, -12, 0 N), prescribed displacements up to 0.001 m"; empty if nothing
  /// acts.
  [[nodiscard]] std::string description() const;
};

/// @param ranks that have parts of the body; collective
[[nodiscard]] Preload find_preload(const Conditions& conditions, const Communicator& ranks);

}  // namespace peristat
