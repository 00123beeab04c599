#pragma once

#include <stdexcept>
#include <string>

namespace peristat {

/// A case that does not fit (exit code 4); told before the memory is asked for.
class MemoryError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Memory that this process may still take [bytes]: what the system calls available, limited by the
/// control group and by the limit of the address space.
[[nodiscard]] double available_memory();

/// "1.5 GB"
[[nodiscard]] std::string bytes_text(double bytes);

/// @throws MemoryError unless `bytes` are available
void require_memory(double bytes, const std::string& for_what);

}  // namespace peristat
