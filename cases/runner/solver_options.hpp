#pragma once

#include "cases/runner/case.hpp"
#include "cases/runner/memory.hpp"
#include "solvers/load_stepping.hpp"

namespace peristat {

/// Options of the linear solver as a case gives them.
[[nodiscard]] LinearSolverOptions linear_solver_options(const Case& from);

/// What the choice of a linear solver goes by, for a case and what its body is estimated to need.
[[nodiscard]] LinearProblem linear_problem(const Case& from, const MemoryEstimate& estimate);

/// Options of the load stepping as a case gives them.
[[nodiscard]] LoadSteppingOptions load_stepping_options(const Case& from);

/// Options of Newton's method as a case gives them.
[[nodiscard]] NewtonOptions newton_options(const Case& from);

}  // namespace peristat
