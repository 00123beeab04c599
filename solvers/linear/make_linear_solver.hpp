#pragma once

#include <limits>
#include <memory>
#include <string>

#include "solvers/linear/linear_solver.hpp"
#include "solvers/linear/solver_ladder.hpp"
#include "src/geometry/lattice_box.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

enum class LinearMethod {
  automatic,
  cholesky,
  ldlt,  ///< accepts negative pivots
  conjugate_gradients,
  minres,
  gmres,
  lu,       ///< for unsymmetric tangents
  bicgstab  ///< for unsymmetric tangents
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
  local_operator  ///< for unsymmetric tangents
};

struct LinearSolverOptions {
  LinearMethod method = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
};

/// Returns why this method or preconditioner can't be used with a tangent that is symmetric, or is
/// not; empty if it can.
[[nodiscard]] std::string what_is_against(LinearMethod method, bool is_symmetric);
[[nodiscard]] std::string what_is_against(PreconditionerKind preconditioner, bool is_symmetric);

/// True if a solver with these options can do without a stored tangent.
[[nodiscard]] bool can_be_matrix_free(const LinearSolverOptions& options);

/// Data that the choice of a solver depends on.
struct LinearProblem {
  bool is_symmetric = true;   ///< of the tangent; otherwise it is an UnsymmetricTangent
  double unknowns = 0.0;      ///< for unsymmetric tangents: the length of the vectors of GMRES
  double bonds = 0.0;         ///< blocks of the tangent, or bonds visited by a matrix-free product
  double factor_flops = 0.0;  ///< of one factorisation, as estimated from dimension, size and shape
  double factor_bytes = 0.0;  ///< of the direct solver
  double available_bytes = std::numeric_limits<double>::infinity();
  bool is_stored = true;      ///< tangent is stored: direct solvers and Trilinos' preconditioners
                              ///< need it
  bool may_soften = false;    ///< damage grows in implicit steps: stability is in question
  bool solves_often = false;  ///< many systems have the same tangent
  bool has_inertia = false;   ///< masses are part of the tangent, as in implicit time steps
  const IndexMap* index_map = &whole_body();  ///< of the body's points; it outlives the solver
  /// Lattice sites of the points, which `sines` needs; null: `sines` can't be used.
  std::shared_ptr<const LatticeBox> box{};
};

/// A solver with the reason for its choice, in words.
struct ChosenSolver {
  std::unique_ptr<LinearSolver> solver;
  bool is_direct = true;
  double seconds = 0.0;  ///< estimated for the systems of a load step [s]
  std::string reason;
};

/// Makes the solver of a body's linear systems. `automatic` takes the direct solver if a
/// factorisation is small (1e8 flop), if it takes less than a second and either pivots are needed
/// to judge the stability of a softening body or many systems share a tangent, or if it is
/// estimated to be faster. Otherwise it takes conjugate gradients, with sines if there is a box and
/// with rigid pieces if not. A solver that fails gives way to others (SolverLadder).
///
/// For a partitioned body the solver is iterative: no rank has the whole tangent to factorise, nor
/// the whole box of a lattice. Collective; all ranks choose alike.
///
/// For an unsymmetric tangent: BiCGStab with block Jacobi if masses dominate; L U if its factor
/// fits and is small or estimated to be faster; otherwise GMRES with the local operator.
/// @param tell receives each fall of a ladder to the next solver; may be empty
[[nodiscard]] ChosenSolver make_linear_solver(const LinearSolverOptions& options,
                                              const LinearProblem& problem,
                                              SolverLadder::Reporter tell);

}  // namespace peristat
