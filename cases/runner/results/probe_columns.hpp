#pragma once

#include <string>

namespace peristat {

/// Columns that a probe adds to the history: NAME for one component, NAME_x, NAME_y, NAME_z for
/// more.
struct ProbeColumns {
  std::string name;
  int components = 1;
  std::string unit = "1";  ///< of the probed field
};

}  // namespace peristat
