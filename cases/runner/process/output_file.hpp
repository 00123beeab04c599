#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "src/core/machine_error.hpp"

namespace peristat {

/// A file that can't be written (folder gone, disk full, ...); names the file and the system's
/// reason.
class OutputError : public MachineError {
 public:
  /// @param cause the system's error number, 0 where there is none
  explicit OutputError(const std::string& message, int cause = 0)
      : MachineError(message), cause_(cause) {}

  [[nodiscard]] int cause() const { return cause_; }

 private:
  int cause_;
};

/// True if an error of the system concerns the machine's resources (room, descriptors, limits of
/// the shell, a device) and not the path that was asked for.
[[nodiscard]] bool is_about_means(int error);

/// Thrown for a file that this program has not written, and leaves as it is; the message says why.
class ForeignFile : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens a file that a person has named. It may be new, empty, or no plain file (a terminal, a
/// pipe, /dev/null). A file with contents must begin with the heading, the first line of each file
/// that is opened by this function; the contents are then dropped. Links are followed; one that
/// leads nowhere is refused.
/// @throws ForeignFile, OutputError; nothing is changed then
[[nodiscard]] std::FILE* open_own_file(const std::filesystem::path& file, std::string_view heading);

/// Writes a new file in place of any entry of this name: a link is replaced, never followed.
/// @throws OutputError; the file is then removed
void write_file(const std::filesystem::path& file, std::string_view contents);

/// Replaces a file in one step: a reader, or a kill at any moment, finds the old contents or the
/// new ones and nothing between. The new contents are first written to the path with ".tmp"
/// appended.
/// @throws OutputError; the file then keeps its old contents
void publish_file(const std::filesystem::path& file, std::string_view contents);

/// Replaces a file in one step, using the room that `reserve_file` has set aside for the path with
/// ".tmp" appended, so that it works on a full disk.
/// @throws OutputError
void publish_reserved_file(const std::filesystem::path& file, std::string_view contents);

/// Sets room on the disk aside, so that later writes up to this size can't find it full; the file
/// becomes this long.
/// @throws OutputError
void reserve_file(const std::filesystem::path& file, std::uint64_t bytes);

/// Gives a complete file its final name, in place of a file that has this name already.
/// @throws OutputError
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Waits until a file, or the names in a folder, have reached the disk, if the file system supports
/// that.
/// @throws OutputError
void sync_file(const std::filesystem::path& file);

/// The path with ".tmp" appended.
[[nodiscard]] std::filesystem::path temporary(const std::filesystem::path& file);

}  // namespace peristat
