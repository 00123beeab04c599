#pragma once

#include <limits>
#include <memory>
#include <string>

#include "solvers/linear/linear_solver.hpp"
#include "solvers/linear/solver_ladder.hpp"
#include "src/geometry/lattice_box.hpp"

namespace peristat {

enum class LinearMethod {
  automatic,
  cholesky,
  ldlt,  ///< bears negative pivots
  conjugate_gradients,
  minres,
  gmres
};

enum class TangentStorage { automatic, stored, matrix_free };

enum class PreconditionerKind {
  automatic,
  jacobi,
  block_jacobi,
  rigid_pieces,
  surrogate,
  sines,  ///< for bodies on a lattice: see LinearProblem::box
  riluk,
  chebyshev,
  multigrid
};

struct LinearSolverOptions {
  LinearMethod method = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
};

/// Whether a solver with these options can do without a stored tangent.
[[nodiscard]] bool can_be_matrix_free(const LinearSolverOptions& options);

/// What the choice of a solver goes by.
struct LinearProblem {
  double bonds = 0.0;         ///< blocks of the tangent
  double factor_flops = 0.0;  ///< of one factorisation, as estimated from dimension, size and shape
  double factor_bytes = 0.0;  ///< of the direct solver
  double available_bytes = std::numeric_limits<double>::infinity();
  bool is_stored = true;      ///< the tangent: direct solvers and Trilinos' preconditioners need it
  bool may_soften = false;    ///< damage grows in implicit steps: stability is in question
  bool solves_often = false;  ///< many systems have the same tangent
  /// Where the points stand, which sines need; nothing: they can't be taken.
  std::shared_ptr<const LatticeBox> box{};
};

/// A solver with the reason for its choice, in words.
struct ChosenSolver {
  std::unique_ptr<LinearSolver> solver;
  bool is_direct = true;
  double seconds = 0.0;  ///< estimated for the systems of a load step [s]
  std::string reason;
};

/// Solver of a body's linear systems. `automatic` takes the direct solver where a factorisation is
/// a matter of a tenth of a second, where pivots are to tell whether a softening body is stable and
/// a factorisation takes less than a second, and where it is estimated to be faster; otherwise
/// conjugate gradients with rigid pieces. Both give way to others when they fail (SolverLadder).
/// @param tell of a ladder's falls; may be empty
[[nodiscard]] ChosenSolver make_linear_solver(const LinearSolverOptions& options,
                                              const LinearProblem& problem,
                                              SolverLadder::Reporter tell);

}  // namespace peristat
