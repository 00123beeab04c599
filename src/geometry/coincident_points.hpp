#pragma once

#include <optional>
#include <utility>

#include "src/geometry/points.hpp"

namespace peristat {

/// Part of the spacing within which two points stand at one place.
inline constexpr double same_place_tolerance = 1e-9;

/// Finds two points whose coordinates differ by no more than the tolerance [m], the one with the
/// smaller number first.
[[nodiscard]] std::optional<std::pair<Index, Index>> points_at_one_place(const Points& points,
                                                                         double tolerance);

}  // namespace peristat
