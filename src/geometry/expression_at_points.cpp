#include "src/geometry/expression_at_points.hpp"

#include <utility>

namespace peristat {

const GivenFunctions& functions_of(const std::shared_ptr<const GivenFunctions>& of) {
  static const GivenFunctions none;
  return of ? *of : none;
}

Expression expression_of(const std::string& text, const Points& points,
                         std::vector<std::string> parameters) {
  return {text,           points.dimension,
          points.spacing, std::move(parameters),
          points.columns, functions_of(points.functions)};
}

Expression expression_of(const std::string& text, const Lattice& lattice) {
  static const Columns none;
  return {text, lattice.dimension, lattice.spacing, {}, none, functions_of(lattice.functions)};
}

double value_at(const Expression& expression, const Points& points, Index point,
                std::span<const double> parameters) {
  return expression(points.position(point), parameters, points.source(point));
}

std::vector<double> values_at(const Expression& expression, const Points& points,
                              std::span<const Index> at, std::span<const double> parameters) {
  if (expression.is_constant()) return std::vector<double>(at.size(), expression({}));
  std::vector<Coordinates> places;
  std::vector<Index> sources;
  for (const Index point : at) {
    places.push_back(points.position(point));
    sources.push_back(points.source(point));
  }
  return expression.at(places, parameters, sources);
}

}  // namespace peristat
