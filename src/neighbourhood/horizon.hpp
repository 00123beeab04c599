#pragma once

namespace peristat {

/// Relative tolerance of "inside the horizon": a lattice neighbour at exactly the horizon counts as
/// inside whatever the round-off of its coordinates.
inline constexpr double horizon_tolerance = 1e-8;

/// Triangles with a reference area (tetrahedra with a reference volume) below this times the square
/// (cube) of the horizon are collinear (coplanar) and do not interact: their measure has no
/// relative change. Round-off of lattice coordinates stays ten orders below it.
inline constexpr double flatness_tolerance = 1e-6;

/// Largest distance that counts as inside a radius [m].
[[nodiscard]] constexpr double reach(double radius) { return radius * (1.0 + horizon_tolerance); }

}  // namespace peristat
