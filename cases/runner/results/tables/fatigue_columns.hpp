#pragma once

#include <map>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// Column of the history that mode fatigue has: cycles, the number so far; in other modes none.
[[nodiscard]] std::vector<ProbeColumns> fatigue_columns(const Case& from);

/// Adds the value of this column in a state.
void add_fatigue_values(const StepRecord& record, const Case& from,
                        std::map<std::string, std::vector<double>>& values);

}  // namespace peristat
