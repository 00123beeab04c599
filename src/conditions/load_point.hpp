#pragma once

#include <optional>

namespace peristat {

/// A stage of the loading programme, at which supports and loads have values. Under a displacement
/// control the first load parameter is found with the state, not given by the programme.
struct LoadPoint {
  double stage = 0.0;
  std::optional<double> load = std::nullopt;  ///< replaces the programme's first parameter
  /// Fraction of the preload, which acts at load 0, that is applied: below 1 only on the way to
  /// step 0.
  double preload = 1.0;

  LoadPoint(double at, std::optional<double> found = std::nullopt)  // NOLINT: a stage is a point
      : stage(at), load(found) {}

  /// At load 0, with this fraction of the preload. Every load parameter is 0, also a found one.
  [[nodiscard]] static LoadPoint of_preload(double share) {
    LoadPoint at(0.0);
    at.preload = share;
    return at;
  }

  friend bool operator==(const LoadPoint&, const LoadPoint&) = default;
};

}  // namespace peristat
