#pragma once

#include <stdexcept>
#include <string>

namespace peristat {

/// Thrown if a case does not fit into memory (exit code 4), before the memory is allocated.
class MemoryError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Memory that this process may still allocate [bytes]: what the system reports as available,
/// limited by the control group and by the limit of the address space.
[[nodiscard]] double available_memory();

/// "1.5 GB"
[[nodiscard]] std::string bytes_text(double bytes);

/// @throws MemoryError unless `bytes` are available
void require_memory(double bytes, const std::string& for_what);

}  // namespace peristat
