#pragma once

#include <optional>
#include <string>
#include <vector>

#include "src/core/coordinates.hpp"

namespace peristat {

/// Statistic of a field's values over a set.
enum class Statistic { mean, max, min, rms_error, max_error };

/// True for statistics of the difference from expected values.
[[nodiscard]] constexpr bool is_of_error(Statistic statistic) {
  return statistic == Statistic::rms_error || statistic == Statistic::max_error;
}

/// A value of a field in a state: over a set, at the point nearest to a place, or for every point
/// along a line. Exactly one of `set`, `at` and `from` is given.
struct ProbeSpecification {
  std::string name{}, set{};
  std::optional<Coordinates> at{}, from{}, to{};  ///< [m]
  /// One of point_fields, or poisson_ratio, opening or a crack measure of a set
  std::string field = "displacement";
  std::string component{};  ///< of a vector or tensor; empty: all
  Statistic statistic = Statistic::mean;
  /// Statistics of errors: expected components, expressions of place and load parameters.
  std::vector<std::string> expected{};
  int axis = 0;         ///< poisson_ratio: direction that is pulled; crack_length: of the crack
  std::string other{};  ///< opening: set whose mean displacement is subtracted
};

}  // namespace peristat
