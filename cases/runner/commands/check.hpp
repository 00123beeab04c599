#pragma once

#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/case.hpp"

namespace peristat {

/// Reads and builds a case without solving it and prints what it would be: counts, sets, supports,
/// neighbours, parts that may move freely, memory and time.
/// @throws InputError, MemoryError as a run would
[[nodiscard]] Exit check(const Case& from, int threads);

}  // namespace peristat
