#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// Cycles of the load, and the laws by which bonds age in them.
[[nodiscard]] Table<FatigueOptions> fatigue_keys();

/// Refuses mode fatigue without its table, and the table in other modes.
void check_fatigue_table(const Entry& at, const Case& result);

}  // namespace peristat
