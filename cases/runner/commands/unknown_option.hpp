#pragma once

#include <string>
#include <vector>

namespace peristat {

/// Sentence about unexpected words of the command line. For an option it suggests the key of the
/// case file that it names ("--steps 3": --set loading.steps=3), or the nearest option of the
/// command.
/// @param words     unexpected words, at least one
/// @param options   long options of the command ("--threads")
/// @param takes_set true if the command has --set
[[nodiscard]] std::string describe_unknown(const std::vector<std::string>& words,
                                           const std::vector<std::string>& options, bool takes_set);

}  // namespace peristat
