#pragma once

#include <cstddef>

namespace peristat {

/// Whether this process gets so much address space (`ulimit -v`) in one piece; takes none. Needs
/// nothing of the C library but system calls.
[[nodiscard]] bool has_address_space(std::size_t bytes);

}  // namespace peristat
