#include "cases/runner/results/part_probe.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "src/core/expression.hpp"

namespace peristat {
namespace {

/// The members of a set that the rank owns: sets name ghosts, too.
std::span<const Index> owned_members(const Points& points, const std::string& set) {
  const std::vector<Index>& members = points.sets.at(set);
  const auto ghosts = std::lower_bound(members.begin(), members.end(), points.owned.value());
  return {members.begin(), ghosts};
}

/// Means over all members of a set on all ranks.
/// @param value_of of a member, as many numbers as there are columns
template <class ValueOf>
std::vector<double> mean_of(std::span<const Index> members, std::size_t columns,
                            const ValueOf& value_of, const Communicator& ranks) {
  std::vector<double> sums(columns + 1, 0.0);  // and how many there are
  for (const Index point : members) {
    const std::vector<double> values = value_of(point);
    for (std::size_t c = 0; c < columns; ++c) sums[c] += values[c];
  }
  sums[columns] = double(members.size());
  sums = ranks.sum(sums);
  for (std::size_t c = 0; c < columns; ++c) sums[c] /= sums[columns];
  sums.pop_back();
  return sums;
}

/// The largest of each column.
template <class ValueOf>
std::vector<double> largest_of(std::span<const Index> members, std::size_t columns,
                               const ValueOf& value_of, const Communicator& ranks) {
  std::vector<double> largest(columns, -std::numeric_limits<double>::infinity());
  for (const Index point : members) {
    const std::vector<double> values = value_of(point);
    for (std::size_t c = 0; c < columns; ++c) largest[c] = std::max(largest[c], values[c]);
  }
  return ranks.max(largest);
}

std::vector<double> opening_of(const ProbeSpecification& probe, const Points& points,
                               const StepFields& fields, const Communicator& ranks) {
  const auto d = std::size_t(points.dimension);
  const auto displacement = [&](Index point) {
    const auto first = fields.displacement->begin() + std::ptrdiff_t(std::size_t(point) * d);
    return std::vector<double>(first, first + std::ptrdiff_t(d));
  };
  std::vector<double> opening = mean_of(owned_members(points, probe.set), d, displacement, ranks);
  const std::vector<double> other =
      mean_of(owned_members(points, probe.other), d, displacement, ranks);
  for (std::size_t c = 0; c < d; ++c) opening[c] -= other[c];
  return opening;
}

/// Root mean square, or the largest, of the lengths of what separates a set from expected values.
std::vector<double> error_of(const ProbeSpecification& probe, const Points& points,
                             const StepFields& fields, const LoadValues& loads,
                             const Communicator& ranks) {
  std::vector<Expression> expected;
  for (const std::string& text : probe.expected) {
    expected.emplace_back(text, points.dimension, points.spacing, loads.names);
  }
  const auto squared = [&](Index point) {
    const std::vector<double> values = values_at(probe, points.dimension, fields, point);
    double sum = 0.0;
    for (std::size_t c = 0; c < values.size(); ++c) {
      const double difference = values[c] - expected[c](points.position(point), loads.values);
      sum += difference * difference;
    }
    return std::vector<double>{sum};
  };
  const std::span<const Index> members = owned_members(points, probe.set);
  const bool is_largest = probe.statistic == Statistic::max_error;
  return {std::sqrt(is_largest ? largest_of(members, 1, squared, ranks)[0]
                               : mean_of(members, 1, squared, ranks)[0])};
}

}  // namespace

std::vector<double> part_probe_values(const ProbeSpecification& probe, const Points& points,
                                      const StepFields& fields, const LoadValues& loads,
                                      const Communicator& ranks) {
  if (probe.field == "opening") return opening_of(probe, points, fields, ranks);
  if (is_of_error(probe.statistic)) return error_of(probe, points, fields, loads, ranks);
  const std::size_t columns = chosen_components(probe, points.dimension).size();
  const std::span<const Index> members = owned_members(points, probe.set);
  const double sign = probe.statistic == Statistic::min ? -1.0 : 1.0;
  const auto value = [&](Index point) {
    std::vector<double> values = values_at(probe, points.dimension, fields, point);
    for (double& component : values) component *= sign;
    return values;
  };
  if (probe.statistic == Statistic::mean) return mean_of(members, columns, value, ranks);
  std::vector<double> found = largest_of(members, columns, value, ranks);
  for (double& component : found) component *= sign;
  return found;
}

}  // namespace peristat
