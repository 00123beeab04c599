#pragma once

#include "assembly/operators/operator_of_energy.hpp"
#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Tangent of forces that are computed by convolutions: it has products, diagonal blocks, bounds of
/// row sums and a mean stencil, but no rows.
struct ConvolvedTangent : OperatorOfEnergy<TangentOperator> {
  explicit ConvolvedTangent(Energy& energy);

  /// @param projection see TermPasses::product; diagonal blocks and row sums ignore it
  void linearise(Energy& energy, const StateView& at, double projection) override;
  /// Frees what `linearise` computes again at little cost.
  void forget();
  [[nodiscard]] bool has_rows() const override { return false; }
  /// @throws std::logic_error
  void for_each_row(const RowVisitor& visit) const override;
  /// Upper bounds, computed in each call: they are rarely needed, and storing them takes a vector.
  void absolute_row_sums(std::span<double> sums) const override;
  [[nodiscard]] LatticeStencil stencil() const override;
  /// False for forces without a potential.
  [[nodiscard]] bool is_symmetric() const override { return energy_->has_potential(); }
};

/// Frees the arrays of a tangent by convolutions until it is linearised again; other tangents keep
/// theirs, which take long to compute.
/// @return whether the tangent is one by convolutions
bool forget_if_convolved(TangentOperator& tangent);

}  // namespace peristat
