#pragma once

#include <array>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// A rigid motion u(x) = t + r x x of the piece that a point belongs to may not have along.t +
/// about.r.
struct HeldMotion {
  Index member = 0;
  Coordinates along{}, about{};
};

/// A free generalised coordinate that points follow: how fast a rigid motion of its member's piece
/// moves it.
struct FreeHandle {
  std::size_t dof = 0;
  HeldMotion moved_by{};
  bool is_slide = false;  ///< moves its member alone, in the direction moved_by.along
};

/// What holds pieces beside their prescribed degrees of freedom.
struct Holding {
  /// Per degree of freedom of the points: prescribed by a support, or on a spring. What only
  /// follows others is not.
  std::vector<char> prescribed;
  std::vector<HeldMotion> motions{};  ///< of which there may be none
  std::vector<BondEnds> links{};      ///< points that move together, bonded or not
  /// Of a part of a body: of each set of points of several ranks that move together, one that this
  /// rank owns; -1: it owns none. All ranks have as many.
  std::vector<Index> ties{};
  std::vector<FreeHandle> handles{};
  /// Whether component [c] of the jump over the period across an axis [a] is free.
  std::array<std::array<bool, 3>, 3> free_jump{};
};

}  // namespace peristat
