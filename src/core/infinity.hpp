#pragma once

#include <limits>

namespace peristat {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace peristat
