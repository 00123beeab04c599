#include "solvers/formulations/specification/body_specification.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

void check_shares(const Points& points) {
  const NeighbourShares* before = nullptr;
  for (const NeighbourShares& pair : points.neighbours) {
    const bool ascends =
        before == nullptr || before->i < pair.i || (before->i == pair.i && before->j < pair.j);
    const bool are_points = pair.i >= 0 && pair.i < pair.j && pair.j < points.count();
    const bool are_shares = pair.of_i >= 0.0 && pair.of_j >= 0.0 && pair.of_i + pair.of_j > 0.0 &&
                            std::isfinite(pair.of_i + pair.of_j);
    require(ascends && are_points && are_shares, "points.neighbours", "",
            "must ascend; each entry needs two points of the body, and shares of at least 0, not "
            "both 0");
    before = &pair;
  }
}

void check_horizons(const Points& points) {
  require(points.horizons.empty() || points.horizons.size() == points.volume.size(),
          "points.horizons", "", "must have one entry for every point, or none at all");
  for (const double horizon : points.horizons) require_positive(horizon, "points.horizons");
}

void check_set(const std::string& name, const std::vector<Index>& members, Index points) {
  for (std::size_t k = 0; k < members.size(); ++k) {
    const bool ascends = k == 0 || members[k - 1] < members[k];
    require(ascends && members[k] >= 0 && members[k] < points, "points.sets", '"' + name + '"',
            "has a number that is not the number of a point, or numbers that do not ascend");
  }
}

void check_column(const std::string& name, const std::vector<double>& values, Index points) {
  const std::string shown = '"' + name + '"', why_not = why_no_column(name);
  require(why_not.empty(), "points.columns", shown, why_not);
  require(values.size() == std::size_t(points), "points.columns", shown,
          "must have a value for every point");
  for (const double value : values) {
    require(std::isfinite(value), "points.columns", shown, "must be finite");
  }
}

}  // namespace

double cross_section_of(const BodySpecification& of, const Points& points) {
  if (points.dimension == 3) return 1.0;
  return of.cross_section == 0.0 ? points.cross_section() : of.cross_section;
}

void check_points(const Points& points) {
  require(points.dimension >= 1 && points.dimension <= 3, "points.dimension",
          std::to_string(points.dimension), "must be 1, 2 or 3");
  require(points.count() > 0, "points", "", "there are no points");
  require(points.reference.size() == points.volume.size() * std::size_t(points.dimension),
          "points.reference", "", "must have as many entries as the dimension for every volume");
  require_positive(points.spacing, "points.spacing");
  const auto is_finite = [](double at) { return std::isfinite(at); };
  const auto odd = std::ranges::find_if_not(points.reference, is_finite);
  if (odd != points.reference.end())
    throw InputError("points.reference", number_text(*odd), "must be finite");
  for (const double volume : points.volume) require_positive(volume, "points.volume");
  check_shares(points);
  for (const auto& [name, values] : points.columns) check_column(name, values, points.own());
  check_horizons(points);
  for (const auto& [name, members] : points.sets) check_set(name, members, points.count());
}

void add_set(Points& points, const SetRule& rule) {
  if (points.sets.contains(rule.name)) {
    throw InputError("name", '"' + rule.name + '"',
                     "there is already a set of this name (sets, layers and the sets of a point "
                     "file share their names)");
  }
  std::vector<Index> members = select(points, rule);
  if (members.empty()) throw InputError("", '"' + rule.name + '"', "the set selects no point");
  points.sets[rule.name] = std::move(members);
}

}  // namespace peristat
