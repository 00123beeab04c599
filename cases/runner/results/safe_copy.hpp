#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "cases/runner/results/results_folder.hpp"
#include "cases/runner/results/step_part.hpp"

namespace peristat {

/// The state of a run that survives a loss of power: what is written reaches the disk when the
/// system likes, and the newest files may be lost or empty. Now and then all files are written
/// through, and results.h5 and the checkpoint get second names that no later step replaces.
class SafeCopy {
 public:
  explicit SafeCopy(const ResultsFolder& folder) : folder_(folder) {}

  /// Whether writing through takes a hundredth of the time since the start, at most.
  [[nodiscard]] bool is_due() const;
  /// Writes through. The folder is as a run can go on from it.
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
  double seconds_expected_ = 0.02;  ///< of the next time; first that of a slow disk
  std::size_t safe_steps_ = 0;
};

}  // namespace peristat
