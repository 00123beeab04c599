#pragma once

#include <filesystem>

#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/settings.hpp"

namespace peristat {

/// Goes on with the run in a results folder from its last checkpoint, as `run` would have done.
/// @param settings what changes from here on: extending_keys alone
/// @param ranks   that go on with it, on however many it was begun; all make this call
/// @throws InputError if there is nothing to go on from, if the case file has changed since, or for
///         a setting that would make it another case; before anything is written
[[nodiscard]] Exit resume(const std::filesystem::path& directory, const Settings& settings,
                          const RunOptions& options, const Communicator& ranks);

}  // namespace peristat
