#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "src/connectivity/holding.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Rigid motions that prescribed degrees of freedom leave to a set of points, taken as one rigid
/// body. A rigid motion m moves the point at x by
///
///   u(x) = t + r x (x - centre) / size
///
/// with m = (t, r): translations along the axes, then rotations about x, y, z (2D: about z; 1D:
/// none). Divided by the size, all entries are of order one.
struct RigidMotions {
  int dimension = 0;
  Coordinates centre{};       ///< of the points [m]
  double size = 0.0;          ///< largest distance of a point from the centre [m]
  int count = 0;              ///< independent free motions
  std::vector<double> basis;  ///< orthonormal m that span them, one after another
};

/// @param positions where the points are, points x dimension, row major [m]
/// @param members the points of the set
/// @param prescribed per degree of freedom
/// @param held other restraints; those of points outside the set are ignored
/// @param smallest_size lower bound of the size, which a set of one point gets [m]
[[nodiscard]] RigidMotions free_rigid_motions(int dimension, std::span<const double> positions,
                                              std::span<const Index> members,
                                              const std::vector<char>& prescribed,
                                              double smallest_size,
                                              std::span<const HeldMotion> held = {});

/// Sums over a set of points from which its free rigid motions are found, so that sums of parts of
/// a set may be added. Row major, one row per rigid motion about a given centre.
struct MotionSums {
  explicit MotionSums(int dimension)
      : moving(std::size_t(dimension * dimension * (dimension + 1) * (dimension + 1) / 4), 0.0),
        held(moving) {}

  double points = 0.0;
  std::vector<double> moving;  ///< of m m^T over all degrees of freedom, m: their rigid motions
  std::vector<double> held;    ///< of m m^T over the held ones
};

/// Adds a point of the set.
/// @param about gives the centre and the size of the set
/// @param prescribed of the point, one flag per component
void add_point(const RigidMotions& about, const Coordinates& place,
               std::span<const char> prescribed, MotionSums& sums);

/// Adds another restraint of the set.
void add_held(const RigidMotions& about, const HeldMotion& motion, MotionSums& sums);

/// Returns the rigid motions about a centre that nothing restrains.
/// @param about gives dimension, centre and size; its motions are ignored
[[nodiscard]] RigidMotions free_rigid_motions(const RigidMotions& about, const MotionSums& sums);

/// Displacement of a point along an axis in each of the free motions.
[[nodiscard]] std::vector<double> moved_by(const RigidMotions& motions, const Coordinates& place,
                                           int axis);

/// Displacement of a handle in each of the free motions.
[[nodiscard]] std::vector<double> moved_by(const RigidMotions& motions, const FreeHandle& handle);

/// Displacements that differ by less than this fraction are alike: round-off must not choose pins.
inline constexpr double alike_displacements = 1e-9;
/// A degree of freedom that moves less than this in a motion, whose displacements are of order one,
/// can't hold it.
inline constexpr double displacement_at_rest = 1e-6;

/// "move along x", "rotate about z", …
[[nodiscard]] std::vector<std::string> motion_names(const RigidMotions& motions);

/// Returns as many degrees of freedom as there are free motions, none of them prescribed, that
/// suppress all of them when they are pinned: statically determinate. They are chosen one by one
/// where the motions that the former ones leave move most, so that they lie far apart and at right
/// angles; the lowest among equals. Fewer if nothing more can be pinned. Parameters as in
/// free_rigid_motions, which gave the motions.
/// @param handles that may be pinned, too
[[nodiscard]] std::vector<std::size_t> determinate_pins(const RigidMotions& motions,
                                                        std::span<const double> positions,
                                                        std::span<const Index> members,
                                                        const std::vector<char>& prescribed,
                                                        std::span<const FreeHandle> handles = {});

}  // namespace peristat
