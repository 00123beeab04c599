#pragma once

#include <cstddef>

namespace peristat {

/// Buffer of OpenBLAS on x86-64: 32 MB << 2; measured as the growth of the address space per
/// thread.
inline constexpr std::size_t blas_buffer_bytes = std::size_t(128) << 20;
/// Room for other allocations while libraries are loaded, and between the check of the room left
/// and the allocation of the buffer, which OpenBLAS retries for ever if it fails.
inline constexpr std::size_t loading_bytes = std::size_t(16) << 20;
/// OpenBLAS of Debian takes no more threads.
inline constexpr int most_blas_buffers = 128;

}  // namespace peristat
