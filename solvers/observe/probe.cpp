#include "solvers/observe/probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "solvers/observe/point_fields.hpp"
#include "solvers/observe/probe_places.hpp"
#include "src/core/input_error.hpp"
#include "src/dense/least_squares.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Reorders values from row by row to column by column.
std::vector<double> by_columns(const std::vector<double>& rows, std::size_t columns) {
  const std::size_t count = rows.size() / columns;
  std::vector<double> result(rows.size());
  for (std::size_t r = 0; r < count; ++r) {
    for (std::size_t c = 0; c < columns; ++c) result[c * count + r] = rows[r * columns + c];
  }
  return result;
}

/// Rows of all ranks with the same least squares. With several ranks, where a set may be large,
/// each rank condenses its rows to as many as there are columns.
std::vector<double> rows_of_all(std::vector<double> mine, std::size_t columns,
                                const Communicator& ranks) {
  if (ranks.count() == 1) return mine;
  const std::size_t rows = mine.size() / columns;
  if (rows > columns) {
    // Columns of the transpose are rows.
    mine = by_columns(condensed_rows(by_columns(mine, columns), int(rows)), columns);
  }
  return concatenated(ranks, mine);
}

/// Poisson's ratio of the homogeneous deformation that fits the displacements of a set best (least
/// squares), -(mean lateral strain) / (strain along the axis); 0 while there is no strain along it.
double fitted_poisson_ratio(const ProbeSpecification& probe, const RecordedPoints& points,
                            const std::vector<double>& displacement) {
  const std::span<const Index> members = points.members(probe.set);
  const int d = points.dimension();
  const auto width = std::size_t(d);
  std::vector<double> mine;  // row by row: position, 1, displacement
  for (const Index member : members) {
    const auto first = std::ptrdiff_t(std::size_t(member) * width);
    const auto place = points.points().reference.begin() + first;
    const auto moved = displacement.begin() + first;
    mine.insert(mine.end(), place, place + d);
    mine.push_back(1.0);
    mine.insert(mine.end(), moved, moved + d);
  }
  const std::size_t columns = 2 * width + 1;
  const std::vector<double> all =
      by_columns(rows_of_all(std::move(mine), columns, points.ranks()), columns);
  const std::size_t rows = all.size() / columns;
  if (rows == 0) return 0.0;
  // The matrix has full rank for any set of two or more points in every direction; for others the
  // smallest solution is taken.
  const std::span<const double> positions = std::span(all).first(rows * (width + 1));
  const std::vector<double> gradient =
      least_squares(positions, int(rows), std::span(all).last(rows * width));
  const auto slope = [&](int axis) { return gradient[std::size_t(axis) * (width + 2)]; };
  double lateral = 0.0;
  for (int c = 0; c < d; ++c) {
    if (c != probe.axis) lateral += slope(c) / (d - 1);
  }
  const double axial = slope(probe.axis);
  return axial == 0.0 ? 0.0 : -lateral / axial;
}

/// Means over the members of a set, on all ranks.
/// @param values_of returns the values of a member, one per column
template <class ValuesOf>
std::vector<double> mean_of(const RecordedPoints& points, const std::string& set,
                            std::size_t columns, const ValuesOf& values_of) {
  const std::span<const Index> members = points.members(set);
  std::vector<double> sums(columns + 1, -0.0);  // neutral, even for the sign of 0
  for (const Index point : members) {
    const std::vector<double> values = values_of(point);
    for (std::size_t c = 0; c < columns; ++c) sums[c] += values[c];
  }
  sums[columns] = double(members.size());
  sums = points.ranks().sum(sums);
  for (std::size_t c = 0; c < columns; ++c) sums[c] /= sums[columns];
  sums.pop_back();
  return sums;
}

/// Largest value of each column, on all ranks.
template <class ValuesOf>
std::vector<double> largest_of(const RecordedPoints& points, const std::string& set,
                               std::size_t columns, const ValuesOf& values_of) {
  std::vector<double> largest(columns, -std::numeric_limits<double>::infinity());
  for (const Index point : points.members(set)) {
    const std::vector<double> values = values_of(point);
    for (std::size_t c = 0; c < columns; ++c) largest[c] = std::max(largest[c], values[c]);
  }
  return points.ranks().max(largest);
}

std::vector<double> opening_of(const ProbeSpecification& probe, const RecordedPoints& points,
                               const std::vector<double>& displacement) {
  const auto d = std::size_t(points.dimension());
  const auto of_point = [&](Index point) {
    const auto first = displacement.begin() + std::ptrdiff_t(std::size_t(point) * d);
    return std::vector<double>(first, first + std::ptrdiff_t(d));
  };
  std::vector<double> opening = mean_of(points, probe.set, d, of_point);
  const std::vector<double> other = mean_of(points, probe.other, d, of_point);
  for (std::size_t c = 0; c < d; ++c) opening[c] -= other[c];
  return opening;
}

/// Root mean square, or the largest, of the lengths of a set's differences from expected values.
double error_over_set(const ProbeSpecification& probe, const RecordedPoints& points,
                      const PointValues& fields, const LoadValues& loads) {
  const std::span<const Index> members = points.members(probe.set);
  std::vector<std::vector<double>> expected;  // per component and point
  for (const std::string& text : probe.expected) {
    const std::vector<double> found = values_at(expression_of(text, points.points(), loads.names),
                                                points.points(), members, loads.values);
    expected.emplace_back(std::size_t(points.points().count()));
    for (std::size_t k = 0; k < members.size(); ++k) {
      expected.back()[std::size_t(members[k])] = found[k];
    }
  }
  const auto squared = [&](Index point) {
    const std::vector<double> values = values_at(probe, points.dimension(), fields, point);
    double sum = 0.0;
    for (std::size_t c = 0; c < values.size(); ++c) {
      const double difference = values[c] - expected[c][std::size_t(point)];
      sum += difference * difference;
    }
    return std::vector<double>{sum};
  };
  return std::sqrt(probe.statistic == Statistic::max_error
                       ? largest_of(points, probe.set, 1, squared)[0]
                       : mean_of(points, probe.set, 1, squared)[0]);
}

std::vector<double> over_set(const ProbeSpecification& probe, const RecordedPoints& points,
                             const PointValues& fields) {
  const std::size_t columns = chosen_components(probe, points.dimension()).size();
  const double sign = probe.statistic == Statistic::min ? -1.0 : 1.0;
  const auto values = [&](Index point) {
    std::vector<double> found = values_at(probe, points.dimension(), fields, point);
    for (double& value : found) value *= sign;
    return found;
  };
  if (probe.statistic == Statistic::mean) return mean_of(points, probe.set, columns, values);
  std::vector<double> found = largest_of(points, probe.set, columns, values);
  for (double& value : found) value *= sign;
  return found;
}

/// Values at the point nearest to a place, which its rank sends to all others.
std::vector<double> at_place(const ProbeSpecification& probe, const RecordedPoints& points,
                             const PointValues& fields) {
  const std::optional<Index> nearest = nearest_recorded(points, *probe.at).here;
  std::vector<double> values;
  if (nearest) values = values_at(probe, points.dimension(), fields, *nearest);
  return concatenated(points.ranks(), values);
}

/// Refuses what a case file's keys refuse (output_keys.cpp).
void require_answer(const ProbeSpecification& probe, const RecordedPoints& points) {
  const auto require = [](bool holds, const char* key, const std::string& value,
                          const char* allowed) {
    if (!holds) throw InputError(key, value, allowed);
  };
  const auto is_set = [&](const std::string& name) { return points.points().sets.contains(name); };
  const PointField* const field = point_field(probe.field);
  const int d = points.dimension();
  require(field != nullptr || std::ranges::count(fields_of_whole_sets(), probe.field) > 0, "field",
          '"' + probe.field + '"', "no field of this name");
  require((probe.at && field != nullptr) || is_set(probe.set), "set", '"' + probe.set + '"',
          "no set of this name");
  require(probe.field != "opening" || is_set(probe.other), "other", '"' + probe.other + '"',
          "no set of this name");
  require(probe.axis >= 0 && probe.axis < d, "axis", std::to_string(probe.axis),
          "must be an axis of the body");
  require(probe.field != "crack_angle" || d == 2, "field", probe.field, "is for dimension 2");
  require_places_of_probes({&probe, 1}, points);
  if (field == nullptr) return;
  require(probe.component.empty() || std::ranges::count(field->components(d), probe.component) > 0,
          "component", '"' + probe.component + '"', "is not a component of this field");
  require(
      !is_of_error(probe.statistic) || probe.expected.size() == chosen_components(probe, d).size(),
      "expected", "", "needs as many expressions as there are components");
}

}  // namespace

const std::vector<std::string>& fields_of_whole_sets() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"poisson_ratio", "opening"};
    for (const CrackMeasure& measure : crack_measures()) all.push_back(measure.name);
    return all;
  }();
  return names;
}

std::vector<std::string> chosen_components(const ProbeSpecification& probe, int dimension) {
  const auto components = point_field(probe.field)->components(dimension);
  if (components.empty()) return {""};
  return probe.component.empty() ? components : std::vector<std::string>{probe.component};
}

std::vector<double> values_at(const ProbeSpecification& probe, int dimension,
                              const PointValues& fields, Index point) {
  const PointField& field = *point_field(probe.field);
  const std::vector<double> values = field.at(fields.at(probe.field), dimension, point);
  if (probe.component.empty()) return values;
  const auto components = field.components(dimension);
  return {values[std::size_t(std::ranges::find(components, probe.component) - components.begin())]};
}

std::vector<double> probe_values(const ProbeSpecification& probe, const RecordedPoints& points,
                                 const PointValues& fields, const CrackState& crack,
                                 const LoadValues& loads) {
  if (probe.field == "poisson_ratio") {
    return {fitted_poisson_ratio(probe, points, fields.at("displacement"))};
  }
  if (const CrackMeasure* measure = crack_measure(probe.field)) {
    const Points& all = points.points();
    return {measure->value(all, all.sets.at(probe.set), probe.axis, crack)};
  }
  if (probe.at) return at_place(probe, points, fields);
  if (probe.field == "opening") return opening_of(probe, points, fields.at("displacement"));
  if (is_of_error(probe.statistic)) return {error_over_set(probe, points, fields, loads)};
  return over_set(probe, points, fields);
}

std::vector<double> probe_values(const ProbeSpecification& probe, Observation& in,
                                 const CrackState& crack, const LoadValues& loads) {
  require_answer(probe, in.points());
  const bool is_of_points = point_field(probe.field) != nullptr;
  static_cast<void>(in.values(is_of_points ? probe.field : "displacement"));
  return probe_values(probe, in.points(), in.computed(), crack, loads);
}

}  // namespace peristat
