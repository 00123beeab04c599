#pragma once

#include "assembly/operators/unsymmetric_tangent.hpp"
#include "solvers/linear/free_dofs.hpp"

namespace peristat {

/// Returns K_ff from the rows of K: one row and one column per equation.
/// @param rows moved in and compacted in place
[[nodiscard]] SparseRows free_rows(SparseRows rows, const FreeDofs& free);

}  // namespace peristat
