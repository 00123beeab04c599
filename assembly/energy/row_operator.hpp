#pragma once

#include "assembly/energy/product_operator.hpp"
#include "assembly/energy/sparse_rows.hpp"

namespace peristat {

/// Rows of the derivative of forces: the whole operator, or its short-range surrogate between
/// adjacent points.
enum class RowReach { whole, local };

/// A tangent that has sparse rows, which need not be symmetric.
class RowOperator : public ProductOperator {
 public:
  [[nodiscard]] virtual SparseRows rows(const StateView& at, RowReach reach) = 0;
  /// Memory that all rows take [bytes].
  [[nodiscard]] virtual double bytes_of_rows() const = 0;
};

}  // namespace peristat
