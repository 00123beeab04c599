#pragma once

#include "assembly/energy/state.hpp"
#include "solvers/drivers/load_stepping_options.hpp"
#include "solvers/linear/make_linear_solver.hpp"
#include "solvers/search/newton.hpp"

namespace peristat {

/// Options for following a body along its load path.
struct StudyOptions {
  LoadSteppingOptions loading{};
  NewtonOptions newton{};
  /// A named preconditioner is used: `automatic` then means conjugate gradients.
  LinearSolverOptions linear{};
  TangentStorage tangent = TangentStorage::automatic;
  /// Of matrix-free products inside conjugate gradients; their true residuals are in full
  /// precision.
  Precision precision = Precision::single;
  int threads = 0;  ///< 0: as many as OpenMP takes by itself
};

/// @throws InputError ("loading.steps", "newton.relative_tolerance", …)
void check_options(const StudyOptions& options);

}  // namespace peristat
