#pragma once

#include <array>
#include <filesystem>
#include <vector>

namespace peristat {

/// Reads the corners of one polygon: x and y per line, in a unit of length [m], separated by a
/// comma or by blanks. The first line may name the columns "x, y"; lines that begin with # and
/// empty ones are left out. The last corner may repeat the first.
/// @throws InputError with file and line; ("file") if it can't be read or has fewer than 3 corners;
///   at most 10 000 are allowed
[[nodiscard]] std::vector<std::array<double, 2>> read_outline(const std::filesystem::path& file,
                                                              double length_unit = 1.0);

}  // namespace peristat
