#pragma once

#include <array>
#include <cstdint>

namespace peristat {

/// Number of a point or of an interaction on this rank.
using Index = std::int32_t;

/// Number of a point in the whole body, of which a rank holds a part.
using GlobalIndex = std::int64_t;

/// Position in an array over all bonds; one rank may hold more than 2^31 of them.
using Offset = std::int64_t;

/// Coordinates of a place [m]; components beyond the dimension are zero.
using Coordinates = std::array<double, 3>;

/// Matrix of three rows; entries beyond the dimension are zero.
using Tensor = std::array<std::array<double, 3>, 3>;

}  // namespace peristat
