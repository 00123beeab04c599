#pragma once

#include "solvers/linear/preconditioner.hpp"
#include "solvers/linear/trilinos/matrix_preconditioner.hpp"
#include "src/core/sharing.hpp"

namespace peristat {

/// Trilinos preconditioners of the stored tangent, which they copy into a matrix of their own:
/// incomplete factorisation, Chebyshev polynomial or multigrid. Multigrid receives the rigid
/// motions of the current configuration.
class AssembledPreconditioner : public Preconditioner {
 public:
  /// @param sharing partition of the body, which outlives this; null: the body is not partitioned
  explicit AssembledPreconditioner(MatrixPreconditionerKind kind, const Sharing* sharing = nullptr)
      : preconditioner_(kind), sharing_(sharing) {}

  void analyze(const BlockPattern&, const FreeDofs& free) override { free_ = &free; }
  /// @throws std::logic_error for a tangent without stored blocks
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override {
    preconditioner_.apply(residual.data(), correction.data());
  }
  [[nodiscard]] std::string describe() const override { return description_; }

 private:
  MatrixPreconditioner preconditioner_;
  const Sharing* sharing_;
  const FreeDofs* free_ = nullptr;
  std::string description_ = "Trilinos";
};

}  // namespace peristat
