#pragma once

#include <string>
#include <vector>

#include "cases/runner/setup/preflight.hpp"

namespace peristat {

/// Warnings about what may not be intended: one sentence each, without "warning:" in front.
[[nodiscard]] std::vector<std::string> warnings_of(const Preflight& of);

}  // namespace peristat
