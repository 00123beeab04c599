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
    std::vector<Index> candidates;
    for (Index point = 0; point < points.count(); ++point) {
      if (rule.shape && !contains(*rule.shape, points.position(point))) continue;
      candidates.push_back(point);
    }
    const std::vector<double> values = values_at(where, points, candidates);
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      if (values[k] != 0.0) members.push_back(candidates[k]);
    }
  } catch (const InputError& error) {
    throw InputError("where", error.value(), error.allowed());
  }
  return members;
}

}  // namespace peristat
