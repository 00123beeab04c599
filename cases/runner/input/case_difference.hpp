#pragma once

#include <string>
#include <vector>

namespace peristat {

/// Differences of two resolved texts of a case, one phrase each: "loading.steps is 30, was 20". At
/// most five, then the number of further ones.
[[nodiscard]] std::vector<std::string> case_differences(const std::string& then,
                                                        const std::string& now);

}  // namespace peristat
