#pragma once

#include "solvers/study/body.hpp"

namespace peristat {

/// Of a body on ranks a call that all make.
/// @throws MemoryError unless so many bytes are free, with what other ranks of the machine need
void require_memory_for(const Body& body, double bytes);

}  // namespace peristat
