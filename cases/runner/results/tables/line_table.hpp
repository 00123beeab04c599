#pragma once

#include <string>
#include <vector>

#include "cases/runner/results/files/table.hpp"
#include "solvers/observe/line_probe.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// A table `line_NAME.csv`, the group /lines/NAME of results.h5: rows of every step.
struct LineTable {
  std::string name;
  std::vector<Column> columns;  ///< the first one is `step`
};

/// step, load_factor, point, distance from the begin of the line, x, y, z, and the values.
[[nodiscard]] LineTable line_table(const ProbeSpecification& probe, int dimension);
/// A row per point.
[[nodiscard]] std::vector<Row> line_rows(const std::vector<LineValues>& line, int dimension,
                                         const StepRecord& record);

}  // namespace peristat
