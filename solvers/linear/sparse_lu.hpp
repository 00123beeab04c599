#pragma once

#include <limits>

#include "solvers/linear/linear_solver.hpp"
#include "solvers/linear/lu_factor.hpp"

namespace peristat {

/// Direct solver for unsymmetric tangents: L U of all their rows. Every tangent that differs from
/// the last one is factorised; if only values have changed, the elimination order is kept.
class SparseLu : public LinearSolver {
 public:
  /// @param most_bytes limit for rows and factor; factorize returns out_of_memory if they need
  ///        more, before they are allocated
  explicit SparseLu(double most_bytes = std::numeric_limits<double>::infinity());

  LinearOutcome analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  void count_pivots(bool /*counts*/) override {}  // signs of pivots mean nothing here
  /// @return singular where the condition number leaves no digit
  /// @throws std::logic_error for a symmetric tangent
  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override;
  LinearOutcome solve(std::span<const double> b, std::span<double> x, double tolerance) override;
  [[nodiscard]] std::optional<Inertia> inertia() const override { return std::nullopt; }
  [[nodiscard]] LinearStatistics statistics() const override { return statistics_; }
  [[nodiscard]] int last_iterations() const override { return 0; }
  [[nodiscard]] std::string describe() const override;

  [[nodiscard]] const LuFactor& factor() const { return factor_; }

 private:
  double most_bytes_;
  LuFactor factor_;
  const FreeDofs* free_ = nullptr;
  const TangentOperator* tangent_ = nullptr;
  LinearStatistics statistics_;
};

}  // namespace peristat
