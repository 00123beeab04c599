#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"

namespace peristat {

/// Absolute path of a file whose name in the case file is relative to its folder.
/// @throws InputError without a key if there is no such file
[[nodiscard]] std::filesystem::path absolute_beside_case(const Case& from, const std::string& name);

/// Files that a case reads, the case file first.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const Case& from);

/// A line for each thing that a program gives (see lines_of), and for each file that the case
/// reads, without the case file: checksum of its bytes and path.
/// @throws InputError without a key if a file can't be read
[[nodiscard]] std::string checksums_of_files(const Case& from);

}  // namespace peristat
