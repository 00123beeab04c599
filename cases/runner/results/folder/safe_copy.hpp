#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "cases/runner/results/folder/results_folder.hpp"
#include "cases/runner/results/parts/step_part.hpp"

namespace peristat {

/// Copy of a run's state that survives a loss of power. The system delays writing to the disk, so
/// that the newest files may be lost or empty. Now and then all files are synchronised with the
/// disk, and results.h5 and the checkpoint get second names that no later step replaces.
class SafeCopy {
 public:
  explicit SafeCopy(const ResultsFolder& folder) : folder_(folder) {}

  /// True if synchronising takes at most a hundredth of the time since the start.
  [[nodiscard]] bool is_due() const;
  /// Synchronises all files with the disk. A run must be able to resume from the folder as it is.
  /// @param points file that holds the points, in the folder
  /// @param steps written so far
  /// @param checkpoint file that was written last
  /// @throws OutputError
  void make(const std::string& points, const std::vector<WrittenStep>& steps,
            const std::filesystem::path& checkpoint);

 private:
  using Clock = std::chrono::steady_clock;

  const ResultsFolder& folder_;
  Clock::time_point start_ = Clock::now();
  double seconds_spent_ = 0.0;
  double seconds_expected_ = 0.02;  ///< of the next time; at first that of a slow disk
  std::size_t safe_steps_ = 0;
};

}  // namespace peristat
