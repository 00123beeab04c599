#pragma once

#include <string>
#include <vector>

#include "cases/runner/results/table.hpp"

namespace peristat {

/// A table `line_NAME.csv`, the group /lines/NAME of results.h5: rows of every step.
struct LineTable {
  std::string name;
  std::vector<Column> columns;  ///< the first one is `step`
};

}  // namespace peristat
