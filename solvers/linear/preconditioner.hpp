#pragma once

#include <span>
#include <string>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// Approximate inverse of K_ff; symmetric and positive definite, except for unsymmetric tangents.
/// For a partitioned body `build` and `apply` are collective; outcomes may differ between ranks,
/// and the worst one counts.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;

  /// Prepares for a pattern, once. The degrees of freedom outlive the preconditioner.
  virtual void analyze(const BlockPattern& pattern, const FreeDofs& free) = 0;

  /// Computes the preconditioner of a tangent, which need not live on.
  /// @return solved; not_positive_definite or singular where the tangent turns out to be so;
  ///         inaccurate where only the preconditioner fails; out_of_memory
  [[nodiscard]] virtual LinearOutcome build(const TangentOperator& tangent) = 0;

  /// correction = M^-1 residual, one entry per equation each; they must not overlap.
  virtual void apply(std::span<const double> residual, std::span<double> correction) = 0;

  /// A few words for the log.
  [[nodiscard]] virtual std::string describe() const = 0;
};

}  // namespace peristat
