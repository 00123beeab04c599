#pragma once

#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// Takes the place of a solver in runs that solve no equations.
class NoSolver : public LinearSolver {
 public:
  [[nodiscard]] LinearOutcome analyze(const BlockPattern&, const FreeDofs&) override {
    return LinearOutcome::solved;
  }
  /// @throws std::logic_error, as `solve` does
  [[nodiscard]] LinearOutcome factorize(const TangentOperator&, FactorUse) override;
  void count_pivots(bool) override {}
  [[nodiscard]] LinearOutcome solve(std::span<const double> b, std::span<double> x,
                                    double tolerance) override;
  [[nodiscard]] std::optional<Inertia> inertia() const override { return {}; }
  [[nodiscard]] LinearStatistics statistics() const override { return {}; }
  [[nodiscard]] int last_iterations() const override { return 0; }
  [[nodiscard]] std::string describe() const override { return "none"; }
};

}  // namespace peristat
