#pragma once

#include <optional>

namespace peristat {

/// Where supports and loads have a value: at a stage of the loading programme. Under a control the
/// first load parameter is not the programme's but found with the state.
struct LoadPoint {
  double stage = 0.0;
  std::optional<double> load = std::nullopt;  ///< in the place of the programme's first parameter

  LoadPoint(double at, std::optional<double> found = std::nullopt)  // NOLINT: a stage is a point
      : stage(at), load(found) {}
};

}  // namespace peristat
