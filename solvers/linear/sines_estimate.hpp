#pragma once

#include <vector>

#include "src/geometry/lattice_box.hpp"

namespace peristat {

/// True if, for an undamaged elastic body, conjugate gradients with Sines are estimated to take no
/// more iterations than with rigid pieces, by what was measured (benchmarks/RESULTS.md). For each
/// component supports must hold whole sides of the box around its free points, and nothing inside.
/// The box must be filled except for holes, which interrupt few rows of lattice sites along its
/// axes. It must be compact, up to 4 times as long as wide in 2D and twice in 3D.
/// @param prescribed one flag per degree of freedom of the points
[[nodiscard]] bool suits_sines(const LatticeBox& box, const std::vector<char>& prescribed);

}  // namespace peristat
