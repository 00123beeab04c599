#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Columns of the history that constraints have besides their reactions: moment_z:SET [N m] and
/// rotation_z:SET [rad] of every rigid set, in 3D of all axes; moment_z:NAME [N m] of every
/// obstacle; and gradient_x:period_y [1] … of every period.
[[nodiscard]] std::vector<ProbeColumns> constraint_columns(const Case& from);

/// Adds the values of these columns in a state. Collective.
void add_constraint_values(const Conditions& conditions, const Trial& state,
                           std::span<const double> external_force, const Communicator& ranks,
                           std::map<std::string, std::vector<double>>& values);

}  // namespace peristat
