#pragma once

#include <functional>
#include <span>

#include "assembly/energy/state.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Called with the off-diagonal blocks (i, partner) of row i of a tangent, each dimension x
/// dimension, row major, in the order of its pattern. Rows of a thread come in ascending order.
using RowVisitor = std::function<void(int thread, Index i, std::span<const double> blocks)>;

/// A tangent that need not be stored: its rows are computed one by one, product and v may be one
/// array, and products can be projected.
class RowVisits {
 public:
  virtual ~RowVisits() = default;

  /// Visits the rows of d2E/dx2 [N/m].
  /// @param projection see BlockTangent::tangent
  /// @param diagonal blocks, overwritten; empty: not wanted
  virtual void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                             std::span<double> diagonal) = 0;
};

}  // namespace peristat
