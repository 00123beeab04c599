#pragma once

#include "cases/runner/commands/run.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// Runs a case that refuse_keys_without_ranks lets pass on several ranks, as `run` does on one:
/// rank 0 tells and writes what all have. A call that all ranks make; the exit code is the same on
/// all.
/// @throws InputError, MemoryError, MachineError, …, perhaps on one rank alone: the others must be
///         ended then (Communicator::abort)
[[nodiscard]] Exit run_on_ranks(const Case& from, const RunOptions& options,
                                const Communicator& ranks);

}  // namespace peristat
