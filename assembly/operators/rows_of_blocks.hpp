#pragma once

#include "assembly/energy/sparse_rows.hpp"
#include "assembly/operators/tangent.hpp"

namespace peristat {

/// Both halves of a stored tangent as sparse rows [N/m], over all degrees of freedom.
[[nodiscard]] SparseRows rows_of_blocks(const Tangent& tangent);

}  // namespace peristat
