#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace peristat {

/// The bytes of a chunk as HDF5 stores them after its filters "shuffle" and "deflate", level 1:
/// first the lowest bytes of all values, then the next ones, and so on, compressed by zlib.
/// @param value_size bytes of each value
[[nodiscard]] std::vector<unsigned char> shuffled_and_deflated(std::span<const std::byte> chunk,
                                                               std::size_t value_size);

}  // namespace peristat
