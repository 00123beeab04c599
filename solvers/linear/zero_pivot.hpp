#pragma once

#include <limits>

namespace peristat {

/// A pivot below this fraction of its matrix' largest entry is zero up to round-off: it has no
/// sign.
inline constexpr double zero_pivot = 1e3 * std::numeric_limits<double>::epsilon();

}  // namespace peristat
