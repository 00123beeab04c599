#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"

namespace peristat {

/// What became of a factorisation or a solve.
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

/// Sums over the life of a solver, for the summary.
struct LinearStatistics {
  std::int64_t factorisations = 0;
  std::int64_t iterations = 0;  ///< of conjugate gradients
  double seconds = 0.0;         ///< wall time in all calls [s]
};

/// Whether an earlier factorisation may stand in as preconditioner for that of a new tangent.
enum class FactorUse { factorize_now, may_reuse };

/// Solves K_ff x = b on the free degrees of freedom. Implementations keep what the pattern
/// determines between tangents.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Once per pattern, before anything else. The pattern and the degrees of freedom outlive the
  /// solver.
  /// @return solved, or out_of_memory
  [[nodiscard]] virtual LinearOutcome analyze(const BlockPattern& pattern,
                                              const FreeDofs& free) = 0;

  /// Takes a new tangent, which must live until the last solve with it.
  [[nodiscard]] virtual LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) = 0;

  /// Whether a tangent that is not positive definite has its pivots' signs counted, where that is
  /// affordable: it costs far more than finding out. Otherwise such a tangent may be singular, too.
  virtual void count_pivots(bool counts) = 0;

  /// x and b have one entry per equation.
  /// @param tolerance of the relative residual ||b - K_ff x|| / ||b||; direct solvers reach what
  ///        they can and only fail where that is gross
  [[nodiscard]] virtual LinearOutcome solve(std::span<const double> b, std::span<double> x,
                                            double tolerance) = 0;

  /// Signs of the pivots of the last factorised tangent, if they are known.
  [[nodiscard]] virtual std::optional<Inertia> inertia() const = 0;

  [[nodiscard]] virtual LinearStatistics statistics() const = 0;

  /// Iterations of the last solve; 0 for a direct solve.
  [[nodiscard]] virtual int last_iterations() const = 0;

  /// Of a ladder of solvers, how many were given up; 0 for a solver by itself.
  [[nodiscard]] virtual int rung() const { return 0; }
  /// Where a ladder begins; before `analyze`.
  virtual void start_at(int /*rung*/) {}

  /// A line for the log: what it is and what it costs.
  [[nodiscard]] virtual std::string describe() const = 0;
};

}  // namespace peristat
