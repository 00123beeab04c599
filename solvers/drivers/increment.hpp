#pragma once

#include <algorithm>

#include "src/conditions/load_point.hpp"
#include "src/conditions/loading_programme.hpp"

namespace peristat {

/// Options for cutting the step of the stage and for its growth.
struct IncrementOptions {
  bool adaptive = true;  ///< cut after a failure and grow again; otherwise a failure ends the run
  double smallest_step = 1e-6;  ///< of the stage; a cut below it ends the run
  double growth = 2.0;          ///< factor of the step after an easy success
};

/// Size of the next step of the stage. A step ends at the next entry of the programme's tables at
/// the latest, so that every entry is reached. Before step 0 it is a step of the preload, which is
/// first tried as a whole.
class Increment {
 public:
  /// @param steps number of equal steps from one entry to the next, the size of the first one
  /// @param largest limit of its growth; 0 means 1 / steps
  /// @param next size of the next step, stored in the path's state; 0: that of the first
  Increment(int steps, double largest, const IncrementOptions& options, double& next)
      : options_(options),
        largest_(largest > 0.0 ? largest : 1.0 / steps),
        first_(std::min(1.0 / steps, largest_)),
        next_(next) {}

  /// Load point to which the next step goes.
  [[nodiscard]] LoadPoint next_point(const LoadPoint& from) const {
    if (from.preload == 1.0) return target(from.stage);
    const double rest = 1.0 - from.preload, step = next_ > 0.0 ? next_ : rest;
    return LoadPoint::of_preload(rest - step > LoadingProgramme::tolerance ? from.preload + step
                                                                           : 1.0);
  }

  /// Length of a step, of the stage or of the preload.
  [[nodiscard]] static double length(const LoadPoint& from, const LoadPoint& to) {
    return from.preload == 1.0 ? to.stage - from.stage : to.preload - from.preload;
  }

  /// Size of the next step; a resumed path may have a smaller limit than before.
  [[nodiscard]] double value() const { return next_ > 0.0 ? std::min(next_, largest_) : first_; }

  /// Target of the next step; the last step to an entry leaves no remainder of round-off.
  [[nodiscard]] double target(double stage) const {
    const double entry = LoadingProgramme::next_entry(stage);
    return entry - stage - value() > LoadingProgramme::tolerance ? stage + value() : entry;
  }

  [[nodiscard]] bool can_cut_to(double increment) const {
    return options_.adaptive && increment >= options_.smallest_step;
  }
  void cut_to(double increment) { next_ = increment; }
  /// Makes steps of the preload as short as those of the programme, if a longer one would damage
  /// the body.
  /// @return true if this one was longer
  bool refine_preload(double attempted) {
    const bool is_longer = attempted > first_ + LoadingProgramme::tolerance;
    if (!can_cut_to(first_) || !is_longer) return false;
    cut_to(first_);
    return true;
  }
  void enlarge_to(double increment) { next_ = std::max(value(), increment); }
  /// @return true if it grew
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
