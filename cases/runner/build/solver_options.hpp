#pragma once

#include "cases/runner/input/case.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/linear/memory_estimate.hpp"

namespace peristat {

/// Options of the linear solver as a case gives them.
[[nodiscard]] LinearSolverOptions linear_solver_options(const Case& from);

/// How the linear systems of a case are solved.
struct LinearSystems {
  ChosenSolver chosen;
  bool is_stored = true;  ///< the tangent
  double bytes = 0.0;     ///< estimated for the whole run

  [[nodiscard]] std::unique_ptr<TangentOperator> make_tangent(Assembler& assembler) const;
};

/// @param estimate what the body is estimated to need
/// @param tell see make_linear_solver
[[nodiscard]] LinearSystems choose_linear_systems(const Case& from, const MemoryEstimate& estimate,
                                                  SolverLadder::Reporter tell);

/// Options of the load stepping as a case gives them.
[[nodiscard]] LoadSteppingOptions load_stepping_options(const Case& from);

/// Options of Newton's method as a case gives them.
[[nodiscard]] NewtonOptions newton_options(const Case& from);

}  // namespace peristat
