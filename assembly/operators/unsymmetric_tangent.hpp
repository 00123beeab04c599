#pragma once

#include <span>

#include "assembly/energy/sparse_rows.hpp"
#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Tangent that is no second derivative of an energy, and not symmetric. `pattern` has no blocks,
/// `diagonal` those of the diagonal, and `multiply` is the operator itself.
struct UnsymmetricTangent : TangentOperator {
  using TangentOperator::TangentOperator;

  /// All of K [N/m], over all degrees of freedom; large.
  [[nodiscard]] virtual SparseRows rows() const = 0;
  /// What rows() takes [bytes], without making them.
  [[nodiscard]] virtual double bytes_of_rows() const = 0;

  /// A short-range stand-in of K [N/m] over all degrees of freedom, for preconditioning.
  [[nodiscard]] virtual SparseRows local_rows() const = 0;

  [[nodiscard]] const UnsymmetricTangent* as_unsymmetric() const override { return this; }

  [[nodiscard]] bool is_symmetric() const override { return false; }

  /// There are no blocks (i, j) to visit.
  /// @throws std::logic_error
  void for_each_row(const RowVisitor& visit) const override;

  /// By rows(), unless one who knows K better overrides it.
  void absolute_row_sums(std::span<double> sums) const override;
};

}  // namespace peristat
