#include "src/geometry/expression_at_points.hpp"

#include <utility>

namespace peristat {

Expression expression_of(const std::string& text, const Points& points,
                         std::vector<std::string> parameters) {
  return {text, points.dimension, points.spacing, std::move(parameters), points.columns};
}

double value_at(const Expression& expression, const Points& points, Index point,
                std::span<const double> parameters) {
  return expression(points.position(point), parameters, points.source(point));
}

}  // namespace peristat
