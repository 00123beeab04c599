#pragma once

#include <array>
#include <vector>

#include "src/geometry/solid.hpp"

namespace peristat {

/// Volume and first moments about a polyhedron's place [m3, m4].
struct PolyhedronPart {
  double volume = 0.0;
  Coordinates moment{};
};

/// How exactly a part is measured.
enum class Accuracy { fine, rough };

/// Part of a convex polyhedron that lies in a body, by rays from a place in it: over the pyramid on
/// each triangle of the faces, with the triangle's points p from the place,
///
///   V = 3 V_pyramid mean of int s^2 ds,   int x dV = 3 V_pyramid mean of p int s^3 ds,
///
/// over the parts of the ray s p, 0 <= s <= 1, that lie in the body, which are exact. Means are by
/// Radon's rule of seven places in triangles that are quartered, up to five times, until it agrees
/// to 1e-5 of the volume (rough: up to three times, 1e-3). Errors have either sign: where a sphere
/// cuts polyhedra as large as half its radius, the fine parts are right to 2e-4, and their sum over
/// all to 1e-5.
/// @param corners from the place [m]
/// @param faces   numbers of the corners around each face
[[nodiscard]] PolyhedronPart polyhedron_in_body(const Coordinates& place,
                                                const std::vector<Coordinates>& corners,
                                                const std::vector<std::vector<std::size_t>>& faces,
                                                double volume, const Solid& body,
                                                Accuracy accuracy);

}  // namespace peristat
