#pragma once

#include "assembly/operators/operator_of_energy.hpp"
#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Tangent of which only the diagonal blocks are stored: rows are computed anew from the energy
/// each time. With TangentKind::nearby products are the tangent's, rows and diagonal those of the
/// matrix near it.
struct MatrixFreeTangent : OperatorOfEnergy<TangentOperator> {
  /// @param precision that rough products may have, see Precision
  /// @throws std::logic_error unless the energy's rows can be visited
  explicit MatrixFreeTangent(Energy& energy, Precision precision = Precision::full);

  void linearise(Energy& energy, const StateView& at, double projection) override;
  [[nodiscard]] bool multiplies_in_place() const override { return true; }
  [[nodiscard]] bool multiplies_in_single() const override;
  void multiply_in_single(std::span<const double> v, std::span<double> result) const override;
  void for_each_row(const RowVisitor& visit) const override;
  /// Bounds of the largest eigenvalue by the rows that are visited.
  void absolute_row_sums(std::span<double> sums) const override;

 private:
  Precision precision_;
};

}  // namespace peristat
