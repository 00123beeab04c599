#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"

namespace peristat {

/// Outcome of a factorisation or a solve.
enum class LinearOutcome {
  solved,
  not_positive_definite,  ///< negative pivots or negative curvature: see inertia()
  singular,               ///< a zero pivot, or values that are not finite
  out_of_memory,
  inaccurate,  ///< the true residual of the solution is too large
};

[[nodiscard]] std::string name(LinearOutcome outcome);

/// Signs of the pivots.
struct Inertia {
  Index positive = 0, negative = 0, zero = 0;
};

/// Sums over the lifetime of a solver, for the summary.
struct LinearStatistics {
  std::int64_t factorisations = 0;
  std::int64_t iterations = 0;  ///< of Krylov methods
  double seconds = 0.0;         ///< wall time in all calls [s]
};

/// What a factorisation is for.
enum class FactorUse {
  factorize_now,
  may_reuse,           ///< an earlier one may serve as preconditioner for the new tangent
  factorize_for_many,  ///< so many solves that substitution matters more; they may be less accurate
                       ///< than a direct solver's, down to the tolerance that they are asked for
};

/// Solves K_ff x = b on the free degrees of freedom. Between tangents, implementations keep what
/// depends on the pattern alone.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Prepares for a pattern; called once per pattern, before anything else. The pattern and the
  /// degrees of freedom outlive the solver.
  /// @return solved, or out_of_memory
  [[nodiscard]] virtual LinearOutcome analyze(const BlockPattern& pattern,
                                              const FreeDofs& free) = 0;

  /// Takes a new tangent, which must live until the last solve with it.
  [[nodiscard]] virtual LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) = 0;

  /// Sets whether to count the signs of the pivots of a tangent that is not positive definite,
  /// where that is affordable: it costs far more than the detection. Without counting, a tangent
  /// reported as not positive definite may be singular.
  virtual void count_pivots(bool counts) = 0;

  /// x and b have one entry per equation.
  /// @param tolerance of the relative residual ||b - K_ff x|| / ||b||; direct solvers reach what
  ///        they can and fail only if the residual is gross
  [[nodiscard]] virtual LinearOutcome solve(std::span<const double> b, std::span<double> x,
                                            double tolerance) = 0;

  /// Signs of the pivots of the last factorised tangent, if they are known.
  [[nodiscard]] virtual std::optional<Inertia> inertia() const = 0;

  [[nodiscard]] virtual LinearStatistics statistics() const = 0;

  /// Iterations of the last solve; 0 for a direct solve.
  [[nodiscard]] virtual int last_iterations() const = 0;

  /// Number of solvers that a ladder has given up; 0 for a solver by itself.
  [[nodiscard]] virtual int rung() const { return 0; }
  /// Sets the rung on which a ladder begins; called before `analyze`.
  virtual void start_at(int /*rung*/) {}

  /// Returns a line for the log: the solver and its cost.
  [[nodiscard]] virtual std::string describe() const = 0;
};

}  // namespace peristat
