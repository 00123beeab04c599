#pragma once

#include <functional>
#include <optional>
#include <string>

namespace peristat {

/// Runs `work` in a process of its own, for libraries that crash on damaged files.
/// @return what an exception said, or how the process ended; nothing if the work is done
[[nodiscard]] std::optional<std::string> fault_aside(const std::function<void()>& work);

}  // namespace peristat
