#pragma once

#include <memory>

#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// Direct solver for tangents that need not be positive definite: L D L^T with pivoting, by MUMPS.
/// The signs of its pivots are always known. Every tangent is factorised, in about the time of
/// Cholesky's factorisation and with twice the memory.
class Ldlt : public LinearSolver {
 public:
  Ldlt();
  ~Ldlt() override;

  LinearOutcome analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  void count_pivots(bool /*counts*/) override {}
  /// @return solved, also with negative pivots; singular for a pivot that is exactly zero
  /// @throws std::logic_error for a tangent without stored blocks
  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override;
  LinearOutcome solve(std::span<const double> b, std::span<double> x, double tolerance) override;
  [[nodiscard]] std::optional<Inertia> inertia() const override;
  [[nodiscard]] LinearStatistics statistics() const override;
  [[nodiscard]] int last_iterations() const override { return 0; }
  [[nodiscard]] std::string describe() const override;

  /// Version of MUMPS; loads its module.
  [[nodiscard]] static std::string library_version();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace peristat
