#pragma once

#include <vector>

#include "src/geometry/lattice_box.hpp"

namespace peristat {

/// Whether conjugate gradients with Sines are estimated to take no more iterations for a whole
/// elastic body than with rigid pieces, by what was measured (benchmarks/RESULTS.md): in each
/// component supports hold whole sides of the box around its free points, and nothing inside; the
/// box is filled but for holes, which few rows of places along its axes meet; and it is compact, up
/// to 4 times as long as wide in 2D and twice in 3D.
/// @param prescribed one flag per degree of freedom of the points
[[nodiscard]] bool suits_sines(const LatticeBox& box, const std::vector<char>& prescribed);

}  // namespace peristat
