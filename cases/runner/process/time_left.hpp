#pragma once

#include <deque>
#include <optional>

namespace peristat {

/// How long a run may take to the end of its path, from the rate of its last steps. It says nothing
/// as long as that would be a guess: in the first steps, while the rate changes (its last half
/// differs by more than a factor of two from the whole), and once damage grows, because how far a
/// crack runs in the next step is not known.
class TimeLeft {
 public:
  /// An accepted step.
  /// @param seconds since the run began
  /// @param share of the path
  /// @param damaged whether bonds have been damaged, or the step was relaxed
  void accepted(double seconds, double share, bool damaged);

  /// [s]; nothing if it would be a guess.
  [[nodiscard]] std::optional<double> seconds() const;

 private:
  struct Moment {
    double seconds, share;
  };
  std::deque<Moment> last_;  // accepted steps, without damage
};

}  // namespace peristat
