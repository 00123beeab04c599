#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/probe_columns.hpp"
#include "solvers/problem/equilibrium.hpp"

namespace peristat {

/// Columns moment_z:SET [N m] and rotation_z:SET [rad] of every rigid set; in 3D of all axes.
[[nodiscard]] std::vector<ProbeColumns> rigid_set_columns(const Case& from);

/// Their values in a state.
void add_rigid_set_values(const Conditions& conditions, const Trial& state,
                          std::span<const double> external_force,
                          std::map<std::string, std::vector<double>>& values);

}  // namespace peristat
