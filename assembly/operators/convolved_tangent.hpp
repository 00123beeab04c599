#pragma once

#include <vector>

#include "assembly/energy/kept_state.hpp"
#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Tangent of forces that are found by convolutions: it multiplies, and knows its diagonal blocks,
/// bounds of its rows' sums, and its mean stencil; there is no row to visit. The energy outlives
/// it.
struct ConvolvedTangent : TangentOperator {
  explicit ConvolvedTangent(Energy& energy);

  [[nodiscard]] std::vector<double> positions() const override;
  /// @param projection see TermPasses::product; diagonal blocks and sums are without
  void linearise(Energy& energy, const StateView& at, double projection) override;
  /// Gives back what `linearise` finds again at little cost.
  void forget();
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool has_rows() const override { return false; }
  /// @throws std::logic_error
  void for_each_row(const RowVisitor& visit) const override;
  /// Numbers that are not less, found anew: they are asked for now and then, and a vector long.
  void absolute_row_sums(std::span<double> sums) const override;
  [[nodiscard]] LatticeStencil stencil() const override;
  /// That of forces without a potential is not.
  [[nodiscard]] bool is_symmetric() const override;

 private:
  Energy* energy_;
  KeptState at_;
  double projection_ = 0.0;
};

/// Lets a tangent of convolutions forget what it has found, until it is linearised again; others
/// keep what took them long to find.
/// @return whether it has
bool forget_if_convolved(TangentOperator& tangent);

}  // namespace peristat
