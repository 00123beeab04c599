#pragma once

#include <memory>
#include <vector>

#include "solvers/linear/preconditioner.hpp"
#include "solvers/linear/trilinos/krylov.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Preconditioned Krylov solver. The true residual b - K x of every solution is computed; it is
/// below the tolerance or of the size of its own round-off.
///
/// Where reuse is allowed, the preconditioner of an earlier tangent is kept until a solve takes
/// more than one and a half times the iterations per digit of the first solve after it was built.
class IterativeSolver : public LinearSolver {
 public:
  /// @param restart number of vectors that GMRES keeps before it restarts
  /// @param ranks ranks that each have a part of the equations, which outlive the solver: the
  ///        tangent multiplies with the whole vector, all calls are collective, and all ranks get
  ///        the same outcomes; null: this rank has all equations
  IterativeSolver(KrylovMethod method, std::unique_ptr<Preconditioner> preconditioner,
                  int max_iterations, int restart = KrylovOptions{}.restart,
                  const Communicator& ranks = sole_rank());

  LinearOutcome analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  void count_pivots(bool) override {}  // inertia is never known
  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override;
  /// @return not_positive_definite where conjugate gradients meet negative curvature, inaccurate at
  ///         the iteration limit or where a preconditioner fails
  LinearOutcome solve(std::span<const double> b, std::span<double> x, double tolerance) override;
  [[nodiscard]] std::optional<Inertia> inertia() const override { return std::nullopt; }
  [[nodiscard]] LinearStatistics statistics() const override { return statistics_; }
  [[nodiscard]] int last_iterations() const override { return last_iterations_; }
  [[nodiscard]] std::string describe() const override;

 private:
  /// Checks the diagonal: it is finite and, for a symmetric tangent, has no zeros.
  [[nodiscard]] LinearOutcome look_at(const TangentOperator& tangent);
  [[nodiscard]] double norm_of_all(std::span<const double> v) const;
  /// True if no rank has any equations.
  [[nodiscard]] bool is_empty(std::size_t equations) const;
  LinearOutcome build();
  LinearOutcome iterate(std::span<const double> b, std::span<double> x, double tolerance);
  void multiply(std::span<const double> v, std::span<double> product, Precision precision);

  KrylovMethod method_;
  std::unique_ptr<Preconditioner> preconditioner_;
  int max_iterations_, restart_;
  const Communicator& ranks_;
  const FreeDofs* free_ = nullptr;
  const TangentOperator* tangent_ = nullptr;
  LinearStatistics statistics_;
  bool built_ = false;                 // the preconditioner holds numbers
  bool built_now_ = false;             // for the present tangent
  bool worn_ = false;                  // takes too many iterations
  double iterations_per_digit_ = 0.0;  // in the first solve after it was built; 0: none yet
  double largest_diagonal_ = 0.0;
  int last_iterations_ = 0;
  std::vector<double> full_, full_result_;  // per degree of freedom
};

}  // namespace peristat
