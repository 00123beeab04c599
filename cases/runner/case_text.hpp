#pragma once

#include <string>

#include "cases/runner/case.hpp"

namespace peristat {

/// The case as TOML with every key and its value in force; reading it gives the same case again.
[[nodiscard]] std::string resolved_text(const Case& from);

}  // namespace peristat
