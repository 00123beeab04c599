#pragma once

#include "assembly/energy/kept_state.hpp"
#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Tangent of which only the diagonal blocks are stored: products and rows are computed anew from
/// the energy each time. The energy outlives it.
struct MatrixFreeTangent : TangentOperator {
  /// @throws std::logic_error unless the energy's rows can be visited
  explicit MatrixFreeTangent(Energy& energy);

  [[nodiscard]] std::vector<double> positions() const override;
  void linearise(Energy& energy, const StateView& at, double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool multiplies_in_place() const override { return true; }
  void for_each_row(const RowVisitor& visit) const override;

 private:
  Energy* energy_;
  KeptState at_;
  double projection_ = 0.0;
};

}  // namespace peristat
