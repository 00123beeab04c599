#include "src/geometry/point_set.hpp"

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"

namespace peristat {

std::vector<Index> select(const Points& points, const SetRule& rule) {
  if (rule.where.empty() && !rule.shape) {
    throw InputError("where", "", "a set needs an expression (where), a shape, or both");
  }
  if (rule.shape) check_shape(*rule.shape, points.dimension, "shape", "shape");

  std::vector<Index> members;
  try {
    const Expression where = rule.where.empty()
                                 ? Expression(1.0)
                                 : Expression(rule.where, points.dimension, points.spacing);
    for (Index point = 0; point < points.count(); ++point) {
      const Coordinates place = points.position(point);
      if (rule.shape && !contains(*rule.shape, place)) continue;
      if (where(place) != 0.0) members.push_back(point);
    }
  } catch (const InputError& error) {
    throw InputError("where", error.value(), error.allowed());
  }
  return members;
}

}  // namespace peristat
