#pragma once

#include <memory>
#include <vector>

#include "solvers/linear/preconditioner.hpp"
#include "solvers/linear/trilinos/krylov.hpp"

namespace peristat {

/// Preconditioned Krylov solver. Every solution's true residual b - K x is computed, and is below
/// the tolerance or of the size of its own round-off.
///
/// Where reuse is allowed, the preconditioner stays that of an earlier tangent until a solve takes
/// more than one and a half times the iterations per digit of the first one after it was built.
class IterativeSolver : public LinearSolver {
 public:
  /// @param restart vectors that GMRES keeps before it begins anew
  /// @param ranks   that have a part of the equations each, which outlive the solver: the tangent's
  ///                product is that with the whole, all ranks make the same calls and get the same
  ///                outcomes; null: this one has all of them
  IterativeSolver(KrylovMethod method, std::unique_ptr<Preconditioner> preconditioner,
                  int max_iterations, int restart = KrylovOptions{}.restart,
                  const Communicator* ranks = nullptr);

  LinearOutcome analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  void count_pivots(bool) override {}  // they are never known
  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override;
  /// @return not_positive_definite where conjugate gradients meet negative curvature, inaccurate at
  ///         the iteration limit or where a preconditioner fails
  LinearOutcome solve(std::span<const double> b, std::span<double> x, double tolerance) override;
  [[nodiscard]] std::optional<Inertia> inertia() const override { return std::nullopt; }
  [[nodiscard]] LinearStatistics statistics() const override { return statistics_; }
  [[nodiscard]] int last_iterations() const override { return last_iterations_; }
  [[nodiscard]] std::string describe() const override;

 private:
  /// Whether there are values that can be solved with.
  [[nodiscard]] LinearOutcome look_at(const TangentOperator& tangent);
  [[nodiscard]] double norm_of_all(std::span<const double> v) const;
  /// Whether no rank has any of them.
  [[nodiscard]] bool is_empty(std::size_t equations) const;
  LinearOutcome build();
  LinearOutcome iterate(std::span<const double> b, std::span<double> x, double tolerance);
  void multiply(std::span<const double> v, std::span<double> product);

  KrylovMethod method_;
  std::unique_ptr<Preconditioner> preconditioner_;
  int max_iterations_, restart_;
  const Communicator* ranks_;
  const FreeDofs* free_ = nullptr;
  const TangentOperator* tangent_ = nullptr;
  LinearStatistics statistics_;
  bool built_ = false;                 // the preconditioner holds numbers
  bool built_now_ = false;             // of the present tangent
  bool worn_ = false;                  // takes too many iterations
  double iterations_per_digit_ = 0.0;  // of the first solve after it was built; 0: none yet
  double largest_diagonal_ = 0.0;
  int last_iterations_ = 0;
  std::vector<double> full_, full_result_;  // per degree of freedom
};

}  // namespace peristat
