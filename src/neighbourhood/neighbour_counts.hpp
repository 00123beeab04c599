#pragma once

#include <cstdint>
#include <vector>

#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Neighbours of every point, #N1.
[[nodiscard]] std::vector<std::int32_t> neighbour_counts(const Bonds& bonds);

/// Bonds that carry something: those between images, which triangles and tetrahedra may stand on,
/// have no weight.
[[nodiscard]] Offset weighted_bonds(const Bonds& bonds);

}  // namespace peristat
