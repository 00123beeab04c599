#pragma once

#include <vector>

#include "assembly/operators/operator_of_energy.hpp"
#include "assembly/operators/unsymmetric_tangent.hpp"

namespace peristat {

/// Tangent in sparse rows, which are computed on request.
struct RowsOfEnergy : OperatorOfEnergy<UnsymmetricTangent> {
  explicit RowsOfEnergy(Energy& energy);

  /// Ignores the projection: the operator is linear.
  void linearise(Energy& energy, const StateView& at, double projection) override;
  /// Upper bounds.
  void absolute_row_sums(std::span<double> sums) const override;

  [[nodiscard]] SparseRows rows() const override;
  [[nodiscard]] double bytes_of_rows() const override {
    return energy_->forms().rows->bytes_of_rows();
  }
  [[nodiscard]] SparseRows local_rows() const override;

 private:
  std::vector<double> row_sums_;
};

}  // namespace peristat
