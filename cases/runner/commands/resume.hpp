#pragma once

#include <filesystem>
#include <memory>

#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/givens.hpp"
#include "cases/runner/input/settings.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Continues the run in a results folder from its last checkpoint, as `run` would have done.
/// Collective.
/// @param settings changes from here on; extending_keys only
/// @param ranks   that continue it; the run may have begun on another number of ranks
/// @param givens  what a program gives beside the case, as it did when the run began
/// @throws InputError if there is nothing to resume, if the case file has changed since, or for a
///         setting that would make it another case; before anything is written
[[nodiscard]] Exit resume(
    const std::filesystem::path& directory, const Settings& settings, const RunOptions& options,
    const Communicator& ranks,
    const std::shared_ptr<const Givens>& givens = std::make_shared<const Givens>());

}  // namespace peristat
