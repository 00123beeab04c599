#pragma once

#include "solvers/drivers/found_step.hpp"
#include "solvers/drivers/path.hpp"

namespace peristat {

/// True if step 0 is the body at rest: nothing acts at load 0. Otherwise the path's driver applies
/// the preload, in proportion, until step 0 is found.
[[nodiscard]] bool rests_at_load_zero(const Path& path);
/// Accepts the body at rest as step 0.
[[nodiscard]] Advance accept_rest(Path& path);

/// Makes step 0, which has been found, the reference of later steps: increments are those of the
/// programme, the control counts from here. Reports the preload, and the damage that it has done.
void begin_programme(Path& path, const Attempt& step_zero, const FoundStep& found);

}  // namespace peristat
