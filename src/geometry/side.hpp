#pragma once

#include <string>

namespace peristat {

/// A direction along an axis: "x-", "x+", "y-", "y+", "z-", "z+".
struct Side {
  int axis = 0;
  int sign = 1;
  bool operator==(const Side&) const = default;
};

[[nodiscard]] inline std::string name(const Side& side) {
  return std::string(1, "xyz"[side.axis]) + (side.sign > 0 ? "+" : "-");
}

}  // namespace peristat
