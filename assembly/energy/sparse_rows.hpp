#pragma once

#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Rows of a square matrix: row r has the entries [offset[r], offset[r + 1]), columns ascending. An
/// entry may be zero: what is stored depends on what interacts, not on values, so that matrices of
/// one body have one pattern.
struct SparseRows {
  std::vector<Offset> offset;  ///< rows + 1
  std::vector<Index> column;
  std::vector<double> value;

  [[nodiscard]] Index rows() const { return static_cast<Index>(offset.size()) - 1; }
};

}  // namespace peristat
