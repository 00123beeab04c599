#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/results/checkpoint/checkpoint.hpp"

namespace peristat {

/// Two files to which checkpoints are written in turn, in place: a kill leaves one of them whole,
/// and no step has to wait for new files.
class CheckpointFiles {
 public:
  explicit CheckpointFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~CheckpointFiles();
  CheckpointFiles(const CheckpointFiles&) = delete;
  CheckpointFiles& operator=(const CheckpointFiles&) = delete;

  /// @param put_into writes the bytes of a checkpoint, see write_checkpoint
  /// @throws OutputError; the previous checkpoint stays
  void write(const std::function<void(const PutBytes&)>& put_into);

  /// The file that was written last; empty before the first.
  [[nodiscard]] std::filesystem::path last() const;

  /// Names of the files in the folder.
  static constexpr std::array<const char*, 2> names{"checkpoint.0", "checkpoint.1"};

 private:
  std::filesystem::path folder_;
  std::array<int, 2> descriptors_{-1, -1};
  std::size_t next_ = 0;
};

/// Path of the newest checkpoint in a folder that is whole.
/// @throws BadCheckpoint if there is none
[[nodiscard]] std::filesystem::path newest_checkpoint(const std::filesystem::path& folder,
                                                      const std::string& program);

/// Access to the bytes of a file, which are read on demand.
/// @throws BadCheckpoint if it can't be read
[[nodiscard]] CheckpointBytes bytes_of_file(const std::filesystem::path& file);

}  // namespace peristat
