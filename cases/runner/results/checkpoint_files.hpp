#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/results/checkpoint.hpp"

namespace peristat {

/// Two files that checkpoints are written to by turns, in place: a kill leaves one of them whole,
/// and no step has to wait for new files.
class CheckpointFiles {
 public:
  explicit CheckpointFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~CheckpointFiles();
  CheckpointFiles(const CheckpointFiles&) = delete;
  CheckpointFiles& operator=(const CheckpointFiles&) = delete;

  /// @param program version that writes
  /// @throws OutputError; the checkpoint before stays
  void write(Checkpoint checkpoint, const std::string& program);

  /// The file that was written last.
  [[nodiscard]] std::filesystem::path last() const;

  /// Of the checkpoint that was written last; none before the first, or where it can't be read.
  [[nodiscard]] std::vector<std::uint8_t> last_bytes() const;

  /// Names of the files in the folder.
  static constexpr std::array<const char*, 2> names{"checkpoint.0", "checkpoint.1"};

 private:
  std::filesystem::path folder_;
  std::array<int, 2> descriptors_{-1, -1};
  std::size_t next_ = 0;
};

/// The later one of the checkpoints in a folder that are whole.
/// @throws BadCheckpoint if there is none
[[nodiscard]] Checkpoint newest_checkpoint(const std::filesystem::path& folder,
                                           const std::string& program);

/// The checkpoint in a file.
/// @throws BadCheckpoint
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& file,
                                         const std::string& program);

}  // namespace peristat
