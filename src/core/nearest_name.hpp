#pragma once

#include <string>
#include <vector>

namespace peristat {

/// The candidate that a misspelt name most likely means: least number of inserted, deleted,
/// replaced or adjacent swapped characters (Damerau-Levenshtein distance), the first one of equals.
/// @return empty if the least distance exceeds max(2, length of the name / 3) or is the length of
///         the longer name, so that no character is kept
[[nodiscard]] std::string nearest_name(const std::string& name,
                                       const std::vector<std::string>& candidates);

}  // namespace peristat
