#pragma once

#include <memory>

#include "cases/runner/input/case.hpp"
#include "solvers/study/body.hpp"

namespace peristat {

/// Refuses all that a case asks for but what is known to be the same on any number of ranks: keys
/// that are not on the list of docs/cluster.md.
/// @throws InputError with the place of the first such key
void refuse_keys_without_ranks(const Case& from);

/// This rank's part of the body of a case; no rank ever makes more of it. A call that all ranks
/// make.
/// @throws InputError, MemoryError as make_body does, perhaps on one rank alone
[[nodiscard]] std::unique_ptr<const Body> make_part_body(const Case& from,
                                                         const Communicator& ranks, int threads);

}  // namespace peristat
