#pragma once

#include <span>

#include "assembly/convolutions/lattice_stencil.hpp"
#include "assembly/energy/state.hpp"

namespace peristat {

/// What is known of a tangent without blocks, beside its products with vectors.
class ProductOperator {
 public:
  virtual ~ProductOperator() = default;

  /// Adds to both arrays.
  /// @param diagonal blocks, points x dimension x dimension [N/m]
  /// @param row_sums upper bounds of the sums of the absolute entries of rows, per degree of
  ///        freedom [N/m]
  virtual void outline(const StateView& at, std::span<double> diagonal,
                       std::span<double> row_sums) = 0;

  /// The tangent by steps along a lattice; empty where there is none.
  [[nodiscard]] virtual LatticeStencil stencil(const StateView& at) = 0;
};

}  // namespace peristat
