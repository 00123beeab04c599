#pragma once

#include <span>
#include <vector>

#include "src/core/types.hpp"

struct cholmod_factor_struct;  // of CHOLMOD

namespace peristat {

/// Copy of a supernodal Cholesky factor in single precision, for many substitutions: they are bound
/// by memory, and read half as much. The residual of their solutions is that of single precision.
class SingleFactor {
 public:
  /// @param factor supernodal L L^T with 64-bit indices; may be freed afterwards
  explicit SingleFactor(const cholmod_factor_struct& factor);

  void solve(std::span<const double> b, std::span<double> x);

 private:
  /// Columns that have the same rows below the diagonal, which come first, then the others.
  struct Supernode {
    std::size_t first_column = 0, columns = 0, rows = 0;
    std::size_t row = 0, entry = 0;  ///< places of its rows in row_, and of its columns in entry_
  };

  /// @param columns one after the other, with all rows
  void pack(const Supernode& node, const double* columns);
  void forward(const Supernode& node);
  /// @param at end of its entries
  void backward(const Supernode& node, const float* at);

  std::vector<Supernode> nodes_;
  std::vector<Index> order_, row_;
  /// Of the supernodes' columns, their triangles inverted.
  std::vector<float> entry_;
  std::vector<float> x_, part_;  // solution in the factor's order; rows of a supernode
};

}  // namespace peristat
