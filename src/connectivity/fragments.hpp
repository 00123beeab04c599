#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "src/connectivity/holding.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Fragments cut off by broken bonds: pieces that the supports no longer hold, and loose points on
/// too few bonds. Both make the tangent singular.
struct Fragments {
  /// Per point: 0 in a piece that the supports hold, k = 1, 2, … in the k-th floating piece,
  /// largest first; of equal size, the one with the lowest point first.
  std::vector<std::int32_t> piece;
  int count = 0;             ///< floating pieces
  std::vector<Index> loose;  ///< points on fewer than `dimension` independent bonds, ascending
  /// Per degree of freedom (point x dimension + component): 1 where it must be pinned so that no
  /// piece and no loose point can move freely; never where it is prescribed.
  std::vector<char> pinned;
};

/// Directions n that support a point count as independent if the smallest eigenvalue of the sum of
/// n n^T is above this fraction of the largest. For two directions at an angle a the ratio is
/// tan^2(a/2): 1e-3 rad count as one. Across themselves two such bonds are 4e6 times softer than
/// along, and they have turned by the angle between them as soon as the point has moved by a
/// thousandth of their length: that resistance is not in the tangent. The angle is far above that
/// of displacements that an iteration leaves undecided, about 1e-6 rad, and far below that between
/// bonds of a lattice, 1e-2 rad and more.
inline constexpr double independence_tolerance = 2.5e-7;

/// Finds the pieces and loose points of a body in the state x = reference + displacement, and the
/// degrees of freedom to pin there. All is linear in the motions from x, as the tangent is.
///
/// Pieces are the connected components of the unbroken bonds. A piece floats if its prescribed
/// degrees of freedom leave it a rigid motion.
///
/// Loose points are stripped until none is left. A point i is loose if the directions
///
///   n = (x_j - x_i) / |x_j - x_i| to points j that are not loose, by unbroken bonds, and
///   the axes of the prescribed components of i
///
/// are not independent in all dimensions (independence_tolerance). Loose points are then pinned one
/// by one, the one that needs the fewest pins first. A point gets a pin for each missing dimension,
/// first along the axis that its directions cover least. Once pinned, it supports the other loose
/// points by its unbroken bonds. So a chain that hangs on the body follows it, and a pair of points
/// that broke off is held like a rigid body, both free of stress.
///
/// The other points form cores, connected by unbroken bonds among themselves. Pins far apart
/// suppress the rigid motions that its prescribed degrees of freedom leave to a core, one pin for
/// each. A core that only loose points join to a held piece has pins of its own, but does not
/// float.
///
/// Hinges inside a core are not found: two blocks that share a point or fewer bonds than it takes
/// to hold one on the other, or a chain between two blocks that is not straight. Each of their
/// points has enough bonds and the core counts as rigid, yet parts of it can turn.
///
/// @param broken one flag per bond, or empty: none is broken
/// @param prescribed per degree of freedom: it has no equation
/// @param displacement per degree of freedom [m]
/// @param holding restraints of pieces in this state
/// Collective, with the result of a run on one
///        rank: `loose`, `piece` and `pinned` are those of this rank's own points
[[nodiscard]] Fragments find_fragments(const Points& points, const Bonds& bonds,
                                       std::span<const char> broken,
                                       const std::vector<char>& prescribed,
                                       std::span<const double> displacement, const Holding& holding,
                                       const IndexMap& index_map = whole_body());

}  // namespace peristat
