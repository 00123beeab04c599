#pragma once

#include <array>
#include <vector>

namespace peristat {

/// Tangent between points of a lattice that are `step` apart.
struct StencilEntry {
  std::array<int, 3> step{};  ///< along the lattice's axes, one per opposite pair
  /// Minus the sums of the blocks' diagonal components over all pairs of points [N/m].
  std::array<double, 3> sum{};
};
using LatticeStencil = std::vector<StencilEntry>;

}  // namespace peristat
