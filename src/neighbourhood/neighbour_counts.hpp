#pragma once

#include <cstdint>
#include <vector>

#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Neighbours of every point, #N1.
[[nodiscard]] std::vector<std::int32_t> neighbour_counts(const Bonds& bonds);

}  // namespace peristat
