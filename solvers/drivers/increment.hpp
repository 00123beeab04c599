#pragma once

#include <algorithm>

#include "src/conditions/loading_programme.hpp"

namespace peristat {

/// How the step of the stage is cut and grows.
struct IncrementOptions {
  bool adaptive = true;  ///< cut after a failure and grow again; otherwise a failure ends the run
  double smallest_step = 1e-6;  ///< of the stage; a cut below it ends the run
  double growth = 2.0;          ///< factor of the step after an easy success
};

/// How large a step of the stage is taken next. A step ends at the next entry of the programme's
/// tables at the latest: every entry is reached.
class Increment {
 public:
  /// @param steps equal ones from one entry to the next, of which the first is tried
  /// @param largest that it may grow to; 0 means 1 / steps
  /// @param next size of the next step, kept by the path's state; 0: that of the first
  Increment(int steps, double largest, const IncrementOptions& options, double& next)
      : options_(options),
        largest_(largest > 0.0 ? largest : 1.0 / steps),
        first_(std::min(1.0 / steps, largest_)),
        next_(next) {}

  /// A path may go on with a smaller limit than it had.
  [[nodiscard]] double value() const { return next_ > 0.0 ? std::min(next_, largest_) : first_; }

  /// Target of the next step; the last one to an entry is not left a remainder of round-off.
  [[nodiscard]] double target(double stage) const {
    const double entry = LoadingProgramme::next_entry(stage);
    return entry - stage - value() > LoadingProgramme::tolerance ? stage + value() : entry;
  }

  [[nodiscard]] bool can_cut_to(double increment) const {
    return options_.adaptive && increment >= options_.smallest_step;
  }
  void cut_to(double increment) { next_ = increment; }
  void enlarge_to(double increment) { next_ = std::max(value(), increment); }
  /// @return whether it grew
  bool grow() {
    if (!options_.adaptive || value() >= largest_) return false;
    next_ = std::min(options_.growth * value(), largest_);
    return true;
  }
  void start_again() { next_ = 0.0; }

 private:
  IncrementOptions options_;
  double largest_, first_;
  double& next_;
};

}  // namespace peristat
