#pragma once

#include <vector>

#include "assembly/energy/kept_state.hpp"
#include "assembly/energy/tangent_forms.hpp"
#include "assembly/operators/unsymmetric_tangent.hpp"

namespace peristat {

/// Tangent of kind TangentKind::rows: products are computed anew each time, rows on
/// request. The energy must outlive it.
struct RowsOfEnergy : UnsymmetricTangent {
  explicit RowsOfEnergy(Energy& energy);

  [[nodiscard]] std::vector<double> positions() const override;
  /// Ignores the projection: the operator is linear.
  void linearise(Energy& energy, const StateView& at, double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  /// Upper bounds.
  void absolute_row_sums(std::span<double> sums) const override;

  [[nodiscard]] SparseRows rows() const override;
  [[nodiscard]] double bytes_of_rows() const override {
    return energy_->forms().rows->bytes_of_rows();
  }
  [[nodiscard]] SparseRows local_rows() const override;

 private:
  Energy* energy_;
  KeptState at_;
  std::vector<double> row_sums_;
};

}  // namespace peristat
