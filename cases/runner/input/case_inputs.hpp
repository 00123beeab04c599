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

/// A line per table of the case's expressions: checksum of the file's bytes and its path.
/// @throws InputError without a key if a file can't be read
[[nodiscard]] std::string fingerprints_of_tables(const Case& from);

}  // namespace peristat
