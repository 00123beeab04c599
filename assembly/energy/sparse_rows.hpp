#pragma once

#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Rows of a square matrix: row r has the entries [offset[r], offset[r + 1]), columns ascending. An
/// entry may be zero: the pattern depends on which points interact, not on values, so that all
/// matrices of one body share it.
struct SparseRows {
  std::vector<Offset> offset;  ///< rows + 1
  std::vector<Index> column;
  std::vector<double> value;

  [[nodiscard]] Index rows() const { return static_cast<Index>(offset.size()) - 1; }

  /// Adds another matrix, whose entries join those here; without rows this becomes that matrix.
  void add(SparseRows other);
};

}  // namespace peristat
