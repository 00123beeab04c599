#pragma once

#include <string>
#include <utility>
#include <vector>

namespace peristat {

/// Dotted keys of a case file with TOML values, as `--set` gives them: ("loading.steps", "50").
using Settings = std::vector<std::pair<std::string, std::string>>;

}  // namespace peristat
