#pragma once

#include "solvers/linear/preconditioner.hpp"
#include "solvers/linear/trilinos/matrix_preconditioner.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Trilinos preconditioners of the stored tangent, which they copy into a matrix of their own:
/// incomplete factorisation, Chebyshev polynomial or multigrid. Multigrid receives the rigid
/// motions of the current configuration.
class AssembledPreconditioner : public Preconditioner {
 public:
  /// @param index_map of the body's points; it outlives this
  explicit AssembledPreconditioner(MatrixPreconditionerKind kind,
                                   const IndexMap& index_map = whole_body())
      : preconditioner_(kind), index_map_(index_map) {}

  void analyze(const BlockPattern&, const FreeDofs& free) override { free_ = &free; }
  /// @throws std::logic_error for a tangent without stored blocks
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override {
    preconditioner_.apply(residual.data(), correction.data());
  }
  [[nodiscard]] std::string describe() const override { return description_; }

 private:
  MatrixPreconditioner preconditioner_;
  const IndexMap& index_map_;
  const FreeDofs* free_ = nullptr;
  std::string description_ = "Trilinos";
};

}  // namespace peristat
