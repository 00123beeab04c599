#pragma once

#include <cstdint>
#include <vector>

namespace peristat {

/// Factors of interactions by the kinds of their points.
struct FactorsOfKinds {
  std::vector<std::uint8_t> of_point;  ///< kind of each point, 0 … kinds - 1
  std::size_t kinds = 1;
  /// Factor for points of kinds k, l, m (, n) in any order, at (k kinds + l) kinds + m or ((k kinds
  /// + l) kinds + m) kinds + n; empty: all 1
  std::vector<double> factor;
};

}  // namespace peristat
