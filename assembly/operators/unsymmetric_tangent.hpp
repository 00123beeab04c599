#pragma once

#include "assembly/energy/sparse_rows.hpp"
#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Tangent that is no second derivative of an energy, and not symmetric: `pattern` has no blocks,
/// and `multiply` is the operator itself.
struct UnsymmetricTangent : TangentOperator {
  using TangentOperator::TangentOperator;

  /// All of K [N/m]; large.
  [[nodiscard]] virtual SparseRows rows() const = 0;
  /// What rows() takes, without making them [bytes].
  [[nodiscard]] virtual double bytes_of_rows() const = 0;
  /// A short-range stand-in of K, for preconditioning [N/m].
  [[nodiscard]] virtual SparseRows local_rows() const = 0;

  [[nodiscard]] const UnsymmetricTangent* as_unsymmetric() const override { return this; }
};

}  // namespace peristat
