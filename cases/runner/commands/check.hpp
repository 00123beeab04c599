#pragma once

#include <cstdio>

#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/case.hpp"

namespace peristat {

/// Reads and builds a case without solving it, and prints a summary: counts, sets, supports,
/// neighbours, memory and time. Refuses what a run would refuse, such as parts that may move
/// freely.
/// @throws InputError, MemoryError as a run would
[[nodiscard]] Exit check(const Case& from, int threads, std::FILE* out = stdout);

}  // namespace peristat
