#pragma once

#include <array>
#include <vector>

namespace peristat {

/// What a tangent is between points of a lattice that are so many steps apart.
struct StencilEntry {
  std::array<int, 3> step{};  ///< along the lattice's axes, of two opposite ones one
  /// Minus the sums of the blocks' diagonal components over all pairs of points [N/m].
  std::array<double, 3> sum{};
};
using LatticeStencil = std::vector<StencilEntry>;

}  // namespace peristat
