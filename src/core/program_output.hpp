#pragma once

#include <string>
#include <vector>

namespace peristat {

/// Runs another program and returns what it writes to its standard output; its input is empty, and
/// its messages are dropped.
/// @param words path of the program, and its arguments
/// @throws MachineError if it can't be started, or does not end with the exit code 0
[[nodiscard]] std::string program_output(const std::vector<std::string>& words);

}  // namespace peristat
