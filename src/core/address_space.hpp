#pragma once

#include <cstddef>

namespace peristat {

/// True if this process can get so much address space (`ulimit -v`) in one piece. Reserves nothing.
/// Needs nothing of the C library but system calls.
[[nodiscard]] bool has_address_space(std::size_t bytes);

}  // namespace peristat
