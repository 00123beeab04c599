#pragma once

#include "assembly/energy/sharing.hpp"
#include "solvers/linear/preconditioner.hpp"
#include "solvers/linear/trilinos/matrix_preconditioner.hpp"

namespace peristat {

/// Preconditioners of Trilinos: incomplete factors, Chebyshev polynomial or multigrid of the stored
/// tangent, as a matrix of its own. Multigrid is given the rigid motions of the current
/// configuration.
class AssembledPreconditioner : public Preconditioner {
 public:
  /// @param sharing of a part of a body, which outlives it; null: the body is whole
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
