#pragma once

namespace peristat {

/// Relative tolerance of "inside the horizon": a lattice neighbour at exactly the horizon counts as
/// inside whatever the round-off of its coordinates.
inline constexpr double horizon_tolerance = 1e-8;

/// Largest distance that counts as inside a radius [m].
[[nodiscard]] constexpr double inclusive_radius(double radius) {
  return radius * (1.0 + horizon_tolerance);
}

}  // namespace peristat
