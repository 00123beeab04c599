#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string_view>

namespace peristat {

/// A file that can't be written (folder gone, disk full, ...); names the file and the system's
/// reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Creates the file, or replaces its contents.
/// @throws OutputError; the file is then removed
void write_file(const std::filesystem::path& file, std::string_view contents);

/// Replaces a file in one step: a reader, or a kill at any moment, finds the old contents or the
/// new ones and nothing between. The new contents are first written to the path with ".tmp"
/// appended.
/// @throws OutputError; the file then keeps its old contents
void publish_file(const std::filesystem::path& file, std::string_view contents);

/// Sets room on the disk aside, so that later writes up to this size can't find it full; the file
/// becomes this long.
/// @throws OutputError
void reserve_file(const std::filesystem::path& file, std::uint64_t bytes);

/// Gives a complete file its final name, in place of a file that has this name already.
/// @throws OutputError
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// The path with ".tmp" appended.
[[nodiscard]] std::filesystem::path temporary(const std::filesystem::path& file);

}  // namespace peristat
