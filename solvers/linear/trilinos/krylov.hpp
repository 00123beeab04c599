#pragma once

#include <functional>

#include "src/core/communicator.hpp"

// Stands between C++20 and Trilinos, which is compiled as C++17: this header is read by both.

namespace peristat {

enum class KrylovMethod {
  conjugate_gradients,  ///< matrix and preconditioner symmetric positive definite
  minres,               ///< matrix symmetric, preconditioner symmetric positive definite
  gmres,                ///< any matrix, any linear preconditioner, from the right
  bicgstab,  ///< the same without vectors to keep; for matrices near their preconditioner
};

/// How an iterative solve ended.
enum class KrylovOutcome {
  converged,
  iteration_limit,
  negative_curvature,  ///< conjugate gradients met p.A p <= 0: A is not positive definite
  breakdown,  ///< values that are not finite, a preconditioner that is not positive definite, or a
              ///< residual that no longer falls
};

struct KrylovOptions {
  KrylovMethod method = KrylovMethod::conjugate_gradients;
  double tolerance = 1e-10;   ///< of ||b - A x|| / ||b||
  int max_iterations = 1000;  ///< all restarts together
  int restart = 50;           ///< vectors that GMRES keeps; the other methods keep a fixed number
  /// Ranks that have a part of the equations each, perhaps none; null: this one has all of them.
  const Communicator* ranks = nullptr;
};

struct KrylovResult {
  KrylovOutcome outcome = KrylovOutcome::converged;
  int iterations = 0;
  /// ||b - A x|| / ||b||, computed from the solution and not by the method's recursion.
  double relative_residual = 0.0;
};

/// result = A v; both have one entry per equation and do not overlap.
using VectorMap = std::function<void(const double* v, double* result)>;

/// Solves A x = b from x = 0 by Belos, until ||b - A x|| <= tolerance ||b|| (2-norm).
///
/// Recursive residuals drift away from the true one. Where Belos has converged and b - A x has not,
/// the correction is solved for from there (iterative refinement), as long as that helps.
///
/// Of several ranks each gives its part of the vectors, and the maps get and give it; all norms are
/// those of the whole, so that all ranks end alike.
///
/// Prints nothing. What the maps throw is a breakdown; the one exception that leaves is
/// std::runtime_error where Trilinos can't be loaded. With several ranks all exceptions leave,
/// since others then wait in vain: Communicator::abort is for them.
///
/// @param size of this rank's part
/// @param preconditioner an approximate inverse of A, or empty
/// @param solution the best that was reached, whatever the outcome
[[nodiscard]] KrylovResult solve_krylov(int size, const VectorMap& matrix,
                                        const VectorMap& preconditioner,
                                        const double* right_hand_side, double* solution,
                                        const KrylovOptions& options);

}  // namespace peristat
