#pragma once

#include <cstdint>
#include <vector>

#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Number of neighbours of every point, #N1.
[[nodiscard]] std::vector<std::int32_t> neighbour_counts(const Bonds& bonds);

/// Number of bonds with a weight: bonds between images, which are there as sides of triangles and
/// tetrahedra, have none.
[[nodiscard]] Offset weighted_bonds(const Bonds& bonds);

}  // namespace peristat
