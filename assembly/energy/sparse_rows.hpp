#pragma once

#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Rows of a matrix over all degrees of freedom, compressed; columns of a row ascend.
struct SparseRows {
  std::vector<Offset> offset;
  std::vector<Index> column;
  std::vector<double> value;
};

}  // namespace peristat
