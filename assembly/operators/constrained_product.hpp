#pragma once

#include <memory>
#include <vector>

#include "assembly/operators/tangent_operator.hpp"
#include "src/constraints/constraints.hpp"

namespace peristat {

/// Tangent of a body with images of its points, where K has products alone,
///
///   K_q = J^T K J,
///
/// over its points and the jumps over periods, see Constraints: what ConstrainedTangent is of
/// blocks. Entries of what follows are 0.
struct ConstrainedProduct final : TangentOperator {
  /// Both outlive it.
  /// @param whole K, of the body's points
  ConstrainedProduct(std::unique_ptr<TangentOperator> whole, const Points& points,
                     const Constraints& constraints);

  [[nodiscard]] std::vector<double> positions() const override;
  void linearise(Energy& energy, const StateView& at, double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool has_rows() const override { return false; }
  /// @throws std::logic_error
  void for_each_row(const RowVisitor& visit) const override;
  /// Numbers that are not less: |J|^T |K| |J| of ones.
  void absolute_row_sums(std::span<double> sums) const override;
  [[nodiscard]] bool is_symmetric() const override { return whole_->is_symmetric(); }

 private:
  std::unique_ptr<TangentOperator> whole_;
  const Points& points_;
  const Constraints& constraints_;
  std::vector<double> reference_;     // of points and handles
  std::vector<double> displacement_;  // where K is
  std::vector<double> no_force_;
  mutable std::vector<double> moved_;  // J v
};

/// Tangent of a body whose forces are found by convolutions.
[[nodiscard]] std::unique_ptr<TangentOperator> make_convolved_tangent(
    Energy& energy, const Constraints& constraints);

}  // namespace peristat
