#pragma once

#include <limits>
#include <memory>
#include <string>

#include "assembly/energy/sharing.hpp"
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
  gmres,
  lu,       ///< of unsymmetric tangents
  bicgstab  ///< of unsymmetric tangents
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
  multigrid,
  local_operator  ///< of unsymmetric tangents
};

struct LinearSolverOptions {
  LinearMethod method = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
};

/// Why a tangent that is symmetric, or is not, can't be solved with this method or preconditioner;
/// empty if it can.
[[nodiscard]] std::string what_is_against(LinearMethod method, bool is_symmetric);
[[nodiscard]] std::string what_is_against(PreconditionerKind preconditioner, bool is_symmetric);

/// Whether a solver with these options can do without a stored tangent.
[[nodiscard]] bool can_be_matrix_free(const LinearSolverOptions& options);

/// What the choice of a solver goes by.
struct LinearProblem {
  bool is_symmetric = true;   ///< the tangent; otherwise it is an UnsymmetricTangent
  double unknowns = 0.0;      ///< of unsymmetric tangents: the length of the vectors of GMRES
  double bonds = 0.0;         ///< blocks of the tangent, or what is passed over in a product
  double factor_flops = 0.0;  ///< of one factorisation, as estimated from dimension, size and shape
  double factor_bytes = 0.0;  ///< of the direct solver
  double available_bytes = std::numeric_limits<double>::infinity();
  bool is_stored = true;      ///< the tangent: direct solvers and Trilinos' preconditioners need it
  bool may_soften = false;    ///< damage grows in implicit steps: stability is in question
  bool solves_often = false;  ///< many systems have the same tangent
  bool has_inertia = false;   ///< masses are part of the tangent, as in implicit time steps
  const Sharing* sharing = nullptr;  ///< of a part of a body, which outlives the solver
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
///
/// Of a part of a body, what iterates: no rank has the whole of a tangent to factorise, nor of the
/// box of a lattice. All ranks make the same call and choose alike.
///
/// Of an unsymmetric tangent: BiCGStab with block Jacobi where masses dominate; L U where its
/// factor fits and is estimated to be faster; otherwise GMRES with the local operator.
/// @param tell of a ladder's falls; may be empty
[[nodiscard]] ChosenSolver make_linear_solver(const LinearSolverOptions& options,
                                              const LinearProblem& problem,
                                              SolverLadder::Reporter tell);

}  // namespace peristat
