#pragma once

#include <string>
#include <vector>

namespace peristat {

/// Where two resolved texts of a case differ, a phrase each: "loading.steps is 30, was 20". At most
/// a handful, then how many more.
[[nodiscard]] std::vector<std::string> case_differences(const std::string& then,
                                                        const std::string& now);

}  // namespace peristat
