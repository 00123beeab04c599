#pragma once

#include <deque>
#include <optional>

namespace peristat {

/// Estimates the time to the end of the path from the rate of the last steps. Gives no estimate
/// where it would be a guess: in the first steps, while the rate changes (its last half differs by
/// more than a factor of two from the whole), and once damage grows, because how far a crack runs
/// in the next step is not known.
class TimeLeft {
 public:
  /// Adds an accepted step.
  /// @param seconds since the run began
  /// @param share of the path that is done, from 0 to 1
  /// @param damaged true if bonds have been damaged, or the step was relaxed
  void accepted(double seconds, double share, bool damaged);

  /// Estimated time to the end [s]; nothing if it would be a guess.
  [[nodiscard]] std::optional<double> seconds() const;

 private:
  struct Moment {
    double seconds, share;
  };
  std::deque<Moment> last_;  // accepted steps, without damage
};

}  // namespace peristat
