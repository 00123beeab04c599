#pragma once

#include <string>

#include "src/core/types.hpp"

namespace peristat {

/// Shortest text that reads back as the same number, whatever the locale.
[[nodiscard]] std::string number_text(double value);

/// "(x, y, z)" with the components of the dimension.
[[nodiscard]] std::string place_text(const Coordinates& place, int dimension);

}  // namespace peristat
