#pragma once

#include "src/core/communicator.hpp"

namespace peristat::tests {

/// The ranks that mpirun has started. Tests run on all of them at once, in the same order: nothing
/// may end a test on one rank alone, so that there are expectations only.
[[nodiscard]] const Communicator& all_ranks();

}  // namespace peristat::tests
