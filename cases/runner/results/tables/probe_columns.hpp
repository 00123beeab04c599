#pragma once

#include <string>

#include "solvers/observe/probe_specification.hpp"

namespace peristat {

/// Columns that a probe adds to the history: NAME for one component, NAME_x, NAME_y, NAME_z for
/// more.
struct ProbeColumns {
  std::string name;
  int components = 1;
  std::string unit = "1";  ///< of the probed field
  std::string meaning{};   ///< empty: a probe of the case
};

/// Columns that a probe of a set or a point adds to the history.
[[nodiscard]] ProbeColumns columns_of(const ProbeSpecification& probe, int dimension);

}  // namespace peristat
