#pragma once

#include <functional>
#include <optional>
#include <string>

namespace peristat {

/// Runs `work` in a process of its own, for libraries that crash on damaged files.
/// @return message of an exception, or how the process ended; nothing on success
[[nodiscard]] std::optional<std::string> fault_aside(const std::function<void()>& work);

}  // namespace peristat
