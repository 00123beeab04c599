#pragma once

#include <optional>
#include <string>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/geometry/shape.hpp"

namespace peristat {

/// Rule that selects points for a named set: an expression of x, y, z and the points' columns (true
/// where not zero) or a shape; a point must satisfy all that are given. Points of fictitious layers
/// are candidates too.
struct SetRule {
  std::string name{};
  std::string where{};
  std::optional<Shape> shape{};
};

/// Ascending numbers of the points that satisfy the rule; may be empty. The expression is evaluated
/// only inside the shape.
/// @throws InputError if the rule is empty, the expression is malformed or not finite at a point,
///         or the shape can't be used; its key is relative to the set's table ("where",
///         "shape.radius")
[[nodiscard]] std::vector<Index> select(const Points& points, const SetRule& rule);

}  // namespace peristat
