#include "src/geometry/given_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/coincident_points.hpp"
#include "src/geometry/numbering.hpp"

namespace peristat {
namespace {

[[noreturn]] void refuse_given(const std::string& member, const std::string& value,
                               const std::string& why) {
  throw InputError("points." + member, value, why);
}

void require_length(const std::string& member, std::size_t length, std::size_t wanted) {
  if (length == wanted) return;
  refuse_given(member, "",
               "has " + std::to_string(length) + " numbers; must have " + std::to_string(wanted));
}

void require_finite(const std::string& member, const std::vector<double>& values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isfinite(values[k])) continue;
    refuse_given(member, number_text(values[k]),
                 "must be finite; it is number " + std::to_string(k) + " from 0");
  }
}

/// Numbers in a power of the unit, in SI units. Division keeps the decimals of powers of ten.
std::vector<double> in_metres(const std::vector<double>& given, double unit, int power) {
  std::vector<double> values;
  for (const double value : given) {
    values.push_back(unit < 1.0 ? value / std::pow(1.0 / unit, power)
                                : value * std::pow(unit, power));
  }
  return values;
}

/// Members of a set, ascending and each once.
std::vector<Index> members_of(const std::string& name, std::vector<Index> members, Index count) {
  constexpr std::size_t longest = 100;
  if (name.empty() || name == "." || name.size() > longest) {
    refuse_given("sets", '"' + name + '"',
                 "as the name of a set must have 1 to 100 characters, and can't be '.'");
  }
  std::ranges::sort(members);
  const auto repeated = std::ranges::unique(members);
  members.erase(repeated.begin(), repeated.end());
  if (members.empty()) refuse_given("sets", '"' + name + '"', "the set has no point");
  for (const Index member : {members.front(), members.back()}) {
    if (member >= 0 && member < count) continue;
    refuse_given("sets", '"' + name + '"',
                 "has point " + std::to_string(member) + "; points are numbered from 0 to " +
                     std::to_string(count - 1));
  }
  return members;
}

void take_columns(const Points& given, Points& points) {
  for (const auto& [name, values] : given.columns) {
    const std::string why_not = why_no_column(name);
    if (!why_not.empty())
      refuse_given("columns", '"' + name + '"', "as a column's name " + why_not);
    require_length("columns." + name, values.size(), points.volume.size());
    require_finite("columns." + name, values);
    points.columns[name] = values;
  }
}

}  // namespace

Points points_of_given(const Points& given, double cross_section, double length_unit) {
  constexpr auto most = std::size_t(std::numeric_limits<Index>::max() - 1);
  if (given.volume.empty() || given.volume.size() > most)
    refuse_given("volume", "", "must have a number for each point, and at least one");
  require_length("reference", given.reference.size(),
                 given.volume.size() * std::size_t(given.dimension));
  Points points;
  points.dimension = given.dimension;
  points.reference = in_metres(given.reference, length_unit, 1);
  points.volume = in_metres(given.volume, length_unit, 3);
  require_finite("reference", points.reference);
  require_finite("volume", points.volume);
  double mean = 0.0;
  for (const double volume : points.volume) {
    if (!(volume > 0.0)) refuse_given("volume", number_text(volume), "must be positive");
    mean += volume / points.count();
  }
  points.spacing = std::pow(mean / cross_section, 1.0 / points.dimension);
  for (const auto& [name, members] : given.sets)
    points.sets[name] = members_of(name, members, points.count());
  take_columns(given, points);
  if (const auto pair = points_at_one_place(points, same_place_tolerance * points.spacing)) {
    refuse_given("reference", "",
                 "points " + std::to_string(pair->first) + " and " + std::to_string(pair->second) +
                     " (from 0) have the same position");
  }
  const std::vector<Index> order =
      locality_order(points.dimension, points.spacing, points.reference);
  points = renumbered(points, order);
  points.source_row.assign(order.begin(), order.end());
  return points;
}

}  // namespace peristat
