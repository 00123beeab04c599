#pragma once

#include <optional>

namespace peristat {

/// Where supports and loads have a value: at a stage of the loading programme. Under a control the
/// first load parameter is not the programme's but found with the state.
struct LoadPoint {
  double stage = 0.0;
  std::optional<double> load = std::nullopt;  ///< in the place of the programme's first parameter
  /// Share of what acts at load 0 that has been put on: below 1 only on the way to step 0.
  double preload = 1.0;

  LoadPoint(double at, std::optional<double> found = std::nullopt)  // NOLINT: a stage is a point
      : stage(at), load(found) {}

  /// At load 0, with this share of what acts there. Every load parameter is 0, a found one, too.
  [[nodiscard]] static LoadPoint of_preload(double share) {
    LoadPoint at(0.0);
    at.preload = share;
    return at;
  }

  friend bool operator==(const LoadPoint&, const LoadPoint&) = default;
};

}  // namespace peristat
