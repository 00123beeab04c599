#pragma once

#include <filesystem>
#include <string>

namespace peristat {

/// Text of a case file.
/// @throws InputError with the path if there is no such file (and a similarly named one, if there
///         is any in the same folder or below `cases`), if it is a folder, can't be read or is no
///         text of a sensible size
[[nodiscard]] std::string read_case_text(const std::filesystem::path& file);

}  // namespace peristat
