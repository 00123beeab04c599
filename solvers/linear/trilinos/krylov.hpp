#pragma once

#include <functional>

#include "src/parallel/communicator.hpp"

// Interface between C++20 and Trilinos, which is compiled as C++17: both include this header.

namespace peristat {

enum class KrylovMethod {
  conjugate_gradients,  ///< matrix and preconditioner symmetric positive definite
  minres,               ///< matrix symmetric, preconditioner symmetric positive definite
  gmres,                ///< any matrix, any linear preconditioner, from the right
  bicgstab,  ///< as gmres, without stored vectors; for matrices near their preconditioner
};

/// How an iterative solve ended.
enum class KrylovOutcome {
  converged,
  iteration_limit,
  negative_curvature,  ///< conjugate gradients met p.A p <= 0: A is not positive definite
  breakdown,  ///< values that are not finite, a preconditioner that is not positive definite, or a
              ///< residual that no longer falls
};

/// result = A v; both have one entry per equation and do not overlap.
using VectorMap = std::function<void(const double* v, double* result)>;

struct KrylovOptions {
  KrylovMethod method = KrylovMethod::conjugate_gradients;
  double tolerance = 1e-10;   ///< of ||b - A x|| / ||b||
  int max_iterations = 1000;  ///< all restarts together
  int restart = 50;           ///< vectors that GMRES keeps; the other methods keep a fixed number
  /// Ranks that each have a part of the equations, perhaps none; null: this rank has all of them.
  const Communicator* ranks = nullptr;
  /// A faster map that is A to single precision, for conjugate gradients; empty: none. If they fail
  /// with it or converge slowly, they go on with A itself.
  VectorMap rough_matrix{};
};

struct KrylovResult {
  KrylovOutcome outcome = KrylovOutcome::converged;
  int iterations = 0;
  /// ||b - A x|| / ||b||, computed from the solution and not by the method's recursion.
  double relative_residual = 0.0;
};

/// Solves A x = b from x = 0 by Belos, until ||b - A x|| <= tolerance ||b|| (2-norm).
///
/// Recursive residuals drift away from the true one. If Belos has converged and b - A x has not,
/// the correction is solved for from there (iterative refinement), as long as that helps.
///
/// On several ranks each passes its part of the vectors, and the maps take and return that part.
/// All norms are those of the whole vector, so that all ranks end alike. Collective.
///
/// Prints nothing. Exceptions of the maps count as breakdown; the only exception thrown is
/// std::runtime_error if Trilinos can't be loaded. With several ranks all exceptions are passed on,
/// since the other ranks would wait in vain: the caller should use Communicator::abort.
///
/// @param size number of equations of this rank
/// @param preconditioner an approximate inverse of A, or empty
/// @param solution the best one reached, whatever the outcome
[[nodiscard]] KrylovResult solve_krylov(int size, const VectorMap& matrix,
                                        const VectorMap& preconditioner,
                                        const double* right_hand_side, double* solution,
                                        const KrylovOptions& options);

}  // namespace peristat
