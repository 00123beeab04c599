#pragma once

#include <span>

#include "assembly/energy/sparse_rows.hpp"
#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Unsymmetric tangent, which is no second derivative of an energy. `pattern` has no blocks,
/// `diagonal` has the diagonal blocks, and `multiply` applies the operator.
struct UnsymmetricTangent : TangentOperator {
  using TangentOperator::TangentOperator;

  /// All of K [N/m], over all degrees of freedom; large.
  [[nodiscard]] virtual SparseRows rows() const = 0;
  /// Memory that rows() takes [bytes], without making them.
  [[nodiscard]] virtual double bytes_of_rows() const = 0;

  /// Short-range surrogate of K [N/m] over all degrees of freedom, for preconditioning.
  [[nodiscard]] virtual SparseRows local_rows() const = 0;

  [[nodiscard]] const UnsymmetricTangent* as_unsymmetric() const override { return this; }

  [[nodiscard]] bool is_symmetric() const override { return false; }

  /// There are no blocks (i, j) to visit.
  /// @throws std::logic_error
  void for_each_row(const RowVisitor& visit) const override;

  /// Computed from rows(), unless overridden.
  void absolute_row_sums(std::span<double> sums) const override;
};

}  // namespace peristat
