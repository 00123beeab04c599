#pragma once

#include "solvers/body/body.hpp"

namespace peristat {

/// Collective for a partitioned body.
/// @throws MemoryError unless so many bytes are free, beside the needs of other ranks of the
///         machine
void require_memory_for(const Body& body, double bytes);

}  // namespace peristat
