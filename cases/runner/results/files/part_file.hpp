#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "cases/runner/results/files/hdf5_file.hpp"

namespace peristat {

/// Generous bound of what HDF5 needs in addition to the values of a file [byte].
inline constexpr std::uint64_t room_for_structure = 1 << 16;

/// Publishes a small HDF5 file of a results folder in one step: readers find the old file or this
/// one.
/// @param bytes of the values that `write` writes
/// @throws OutputError
void publish_part(const std::filesystem::path& path, std::uint64_t bytes,
                  const std::function<void(Hdf5File&)>& write);

}  // namespace peristat
