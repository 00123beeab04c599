#include "cases/runner/results/rigid_set_columns.hpp"

namespace peristat {
namespace {

/// Axes about which a body of a dimension turns.
std::vector<int> axes_of(int dimension) {
  if (dimension == 3) return {0, 1, 2};
  return dimension == 2 ? std::vector<int>{2} : std::vector<int>{};
}

std::string column(const char* quantity, int axis, const std::string& set) {
  return std::string(quantity) + "_" + "xyz"[axis] + ":" + set;
}

}  // namespace

std::vector<ProbeColumns> rigid_set_columns(const Case& from) {
  std::vector<ProbeColumns> columns;
  for (const RigidSetSpecification& set : from.constraints.rigid_sets) {
    for (const int axis : axes_of(from.dimension)) {
      columns.push_back({column("moment", axis, set.set), 1, "N m"});
      columns.push_back({column("rotation", axis, set.set), 1, "rad"});
    }
  }
  return columns;
}

void add_rigid_set_values(const Conditions& conditions, const Trial& state,
                          std::span<const double> external_force,
                          std::map<std::string, std::vector<double>>& values) {
  const auto moments = conditions.moments(state.displacement, state.gradient, external_force);
  const auto rotations = conditions.rotations(state.displacement);
  for (const auto& [set, moment] : moments) {
    for (const int axis : axes_of(conditions.dimension())) {
      values[column("moment", axis, set)] = {moment[std::size_t(axis)]};
      values[column("rotation", axis, set)] = {rotations.at(set)[std::size_t(axis)]};
    }
  }
}

}  // namespace peristat
