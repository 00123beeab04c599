#pragma once

#include <map>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// Columns of the history that a body in motion has: time [s], time_step [s], kinetic_energy [J],
/// modified_energy [J], momentum_x … [kg m/s]; in other modes none.
[[nodiscard]] std::vector<ProbeColumns> motion_columns(const Case& from);

/// Adds the values of these columns in a state.
void add_motion_values(const StepRecord& record, int dimension,
                       std::map<std::string, std::vector<double>>& values);

}  // namespace peristat
