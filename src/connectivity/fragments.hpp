#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "src/connectivity/holding.hpp"
#include "src/core/sharing.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// What broken bonds have cut off: pieces that the supports no longer hold, and points that swing
/// on too few bonds. Both make the tangent singular.
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

/// Smallest eigenvalue of the sum of n n^T over the directions n that support a point, relative to
/// the largest, from which on the directions count as independent. Two directions at an angle a
/// have tan^2(a/2): 1e-3 rad count as one. Across themselves two such bonds are 4e6 times softer
/// than along, and they have turned by as much as the angle between them as soon as the point has
/// moved by a thousandth of their length: what they hold it with is not in the tangent. The angle
/// is far above that of displacements that an iteration leaves undecided, about 1e-6 rad, and far
/// below that between bonds of a lattice, 1e-2 rad and more.
inline constexpr double independence_tolerance = 2.5e-7;

/// Finds the pieces and loose points of a body in the state x = reference + displacement, and the
/// degrees of freedom to pin there. All is linear in the motions from x, as the tangent is.
///
/// Pieces are the connected components of the unbroken bonds. One floats if its prescribed degrees
/// of freedom leave it a rigid motion.
///
/// Loose points are stripped until none is left: the directions
///
///   n = (x_j - x_i) / |x_j - x_i| to points j that are not loose, by unbroken bonds, and
///   the axes of the prescribed components of i
///
/// of a loose point i are not independent in all dimensions (independence_tolerance). They are then
/// pinned one by one, the one that needs the fewest pins first: as many of its components as are
/// missing, the axis first that the directions cover least. Once pinned, a point supports the other
/// loose ones by its unbroken bonds. So a chain that hangs on the body follows it, and a pair of
/// points that broke off is held like a rigid body, both free of stress.
///
/// The others form cores, connected by unbroken bonds among themselves. The rigid motions that its
/// prescribed degrees of freedom leave to a core are suppressed by as many pins, far apart. A core
/// that only loose points join to a piece that is held has pins of its own, but does not float.
///
/// Not found are hinges inside of a core: two blocks that share a point or fewer bonds than it
/// takes to hold one on the other, or a chain between two blocks that is not straight. Each of
/// their points has bonds enough and the core counts as rigid, yet parts of it can turn.
///
/// @param broken one flag per bond, or empty: none is broken
/// @param prescribed per degree of freedom: it has no equation
/// @param displacement per degree of freedom [m]
/// @param holding what holds pieces, in this state
/// @param sharing null: the body is whole. Otherwise a call that all ranks make, which find the
///        same as one: `loose`, `piece` and `pinned` are those of the points that are this rank's
[[nodiscard]] Fragments find_fragments(const Points& points, const Bonds& bonds,
                                       std::span<const char> broken,
                                       const std::vector<char>& prescribed,
                                       std::span<const double> displacement, const Holding& holding,
                                       const Sharing* sharing = nullptr);

}  // namespace peristat
