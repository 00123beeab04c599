#pragma once

#include <array>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Restraint of a rigid motion u(x) = t + r x x of the piece that a point belongs to: along.t +
/// about.r must be 0.
struct HeldMotion {
  Index member = 0;
  Coordinates along{}, about{};
};

/// A free generalised degree of freedom that points follow, and the rate at which a rigid motion of
/// its member's piece moves it.
struct FreeHandle {
  std::size_t dof = 0;
  HeldMotion moved_by{};
  bool is_slide = false;  ///< moves its member alone, in the direction moved_by.along
};

/// Restraints of pieces.
struct Holding {
  /// Per degree of freedom of the points: prescribed by a support, or on a spring. Not set for
  /// followers.
  std::vector<char> prescribed;
  std::vector<HeldMotion> motions{};  ///< restraints of rigid motions
  std::vector<BondEnds> links{};      ///< points that move together, bonded or not
  /// For a part of a body: per set of points of several ranks that move together, one point of it
  /// that this rank owns, or -1 if it owns none. All ranks have as many entries.
  std::vector<Index> ties{};
  std::vector<FreeHandle> handles{};
  /// True if component [c] of the jump over the period across an axis [a] is free.
  std::array<std::array<bool, 3>, 3> free_jump{};
};

}  // namespace peristat
