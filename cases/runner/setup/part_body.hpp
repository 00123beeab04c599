#pragma once

#include <memory>

#include "cases/runner/input/case.hpp"
#include "solvers/body/body.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Refuses keys that are not on the list of docs/cluster.md: only those on it are known to give the
/// same results on any number of ranks.
/// @throws InputError with the place of the first such key
void refuse_keys_without_ranks(const Case& from);

/// Builds this rank's part of the body of a case; no rank builds more of it at any time.
/// Collective.
/// @throws InputError, MemoryError as make_body does, perhaps on one rank alone
[[nodiscard]] std::unique_ptr<const Body> make_part_body(const Case& from,
                                                         const Communicator& ranks, int threads);

}  // namespace peristat
