#include "cases/runner/results/tables/constraint_columns.hpp"

#include <algorithm>

#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Axes of rotation in a dimension.
std::vector<int> axes_of(int dimension) {
  if (dimension == 3) return {0, 1, 2};
  return dimension == 2 ? std::vector<int>{2} : std::vector<int>{};
}

std::string column(const char* quantity, int axis, const std::string& set) {
  return std::string(quantity) + "_" + "xyz"[axis] + ":" + set;
}

}  // namespace

std::vector<ProbeColumns> constraint_columns(const Case& from) {
  std::vector<ProbeColumns> columns;
  for (const RigidSetSpecification& set : from.constraints.rigid_sets) {
    for (const int axis : axes_of(from.dimension)) {
      columns.push_back({column("moment", axis, set.set), 1, "N m"});
      columns.push_back({column("rotation", axis, set.set), 1, "rad"});
    }
  }
  for (const ObstacleSpecification& obstacle : from.obstacles) {
    for (const int axis : axes_of(from.dimension)) {
      columns.push_back({column("moment", axis, obstacle.name), 1, "N m"});
    }
    for (int c = 0; c < from.dimension; ++c) {
      if (obstacle.displacement[std::size_t(c)] != "free") continue;
      columns.push_back({column("displacement", c, obstacle.name), 1, "m",
                         "displacement of " + obstacle.name + ", which a force drives"});
    }
  }
  for (const PeriodSpecification& period : from.constraints.periods) {
    for (int c = 0; c < from.dimension; ++c) {
      columns.push_back({column("gradient", c, name_of_period(period)), 1, "1"});
    }
  }
  return columns;
}

void add_constraint_values(const Conditions& conditions, const Trial& state,
                           std::span<const double> external_force, const Communicator& ranks,
                           std::map<std::string, std::vector<double>>& values) {
  auto moments = conditions.moments(state.displacement, state.gradient, external_force);
  const auto rotations = conditions.rotations(state.displacement);
  for (auto& [set, moment] : moments) {
    const std::vector<double> all = ranks.sum(std::vector<double>(moment.begin(), moment.end()));
    std::copy(all.begin(), all.end(), moment.begin());
    for (const int axis : axes_of(conditions.dimension())) {
      values[column("moment", axis, set)] = {moment[std::size_t(axis)]};
      values[column("rotation", axis, set)] = {rotations.at(set)[std::size_t(axis)]};
    }
  }
  for (const Obstacles::Obstacle& of : conditions.obstacles().all()) {
    if (!of.free_axis) continue;
    const auto k = std::size_t(&of - conditions.obstacles().all().data());
    const Coordinates place =
        conditions.obstacles().place_at(k, state.displacement, state.environment).displacement;
    values[column("displacement", int(*of.free_axis), of.name)] = {place[*of.free_axis]};
  }
  for (const auto& [name, action] : conditions.obstacles().actions(
           state.displacement, state.environment, state.history.slips())) {
    const std::vector<double> moment =
        ranks.sum(std::vector<double>(action.moment.begin(), action.moment.end()));
    for (const int axis : axes_of(conditions.dimension())) {
      values[column("moment", axis, name)] = {moment[std::size_t(axis)]};
    }
  }
  for (const auto& [period, gradient] : conditions.mean_gradients(state.displacement)) {
    for (int c = 0; c < conditions.dimension(); ++c) {
      values[column("gradient", c, period)] = {gradient[std::size_t(c)]};
    }
  }
}

}  // namespace peristat
