#pragma once

#include "cases/runner/case.hpp"
#include "solvers/load_stepping.hpp"

namespace peristat {

/// Options of the load stepping as a case gives them.
[[nodiscard]] LoadSteppingOptions load_stepping_options(const Case& from);

/// Options of Newton's method as a case gives them.
[[nodiscard]] NewtonOptions newton_options(const Case& from);

}  // namespace peristat
