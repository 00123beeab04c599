#pragma once

#include <string>
#include <vector>

namespace peristat {

/// Sentence about words of the command line that nobody expected: which they are, and for an option
/// what may have been meant, the nearest option of the command or the key of the case file that it
/// names ("--steps 3": --set loading.steps=3).
/// @param words     that were not expected, at least one
/// @param options   long options of the command ("--threads")
/// @param takes_set whether the command has --set
[[nodiscard]] std::string describe_unknown(const std::vector<std::string>& words,
                                           const std::vector<std::string>& options, bool takes_set);

}  // namespace peristat
