#include "src/geometry/point_set.hpp"

#include "src/core/input_error.hpp"
#include "src/geometry/expression_at_points.hpp"

namespace peristat {

std::vector<Index> select(const Points& points, const SetRule& rule) {
  if (rule.where.empty() && !rule.shape) {
    throw InputError("where", "", "a set needs an expression (where), a shape, or both");
  }
  if (rule.shape) check_shape(*rule.shape, points.dimension, "shape", "shape");

  std::vector<Index> members;
  try {
    const Expression where =
        rule.where.empty() ? Expression(1.0) : expression_of(rule.where, points);
    for (Index point = 0; point < points.count(); ++point) {
      if (rule.shape && !contains(*rule.shape, points.position(point))) continue;
      if (value_at(where, points, point) != 0.0) members.push_back(point);
    }
  } catch (const InputError& error) {
    throw InputError("where", error.value(), error.allowed());
  }
  return members;
}

}  // namespace peristat
