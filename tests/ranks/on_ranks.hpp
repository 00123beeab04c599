#pragma once

#include "src/parallel/communicator.hpp"

namespace peristat::tests {

/// The ranks that mpirun has started. All ranks run the same tests in the same order. No test may
/// end on one rank alone, so that tests use EXPECT macros only.
[[nodiscard]] const Communicator& all_ranks();

}  // namespace peristat::tests
