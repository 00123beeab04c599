#pragma once

#include "src/geometry/part.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Index map of a part of a body. The ranks must outlive it. Collective.
[[nodiscard]] IndexMap make_index_map(const Part& part, const Communicator& ranks);

}  // namespace peristat
