#pragma once

#include "cases/runner/case.hpp"
#include "cases/runner/run.hpp"

namespace peristat {

/// Reads and builds a case without solving it and prints what it would be: counts, sets, supports,
/// neighbours, parts that may move freely, memory and time.
/// @throws InputError, MemoryError as a run would
[[nodiscard]] Exit check(const Case& from, int threads);

}  // namespace peristat
