#pragma once

#include "solvers/drivers/path.hpp"

namespace peristat {

/// Steps a state along a path. A driver keeps nothing between two calls that is not in the path's
/// state, so that another driver of the same kind can go on from a copy of that.
class Driver {
 public:
  explicit Driver(Path& path) : path_(path) {}
  virtual ~Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// Takes the next step, or a decision that must precede it. The first step is step 0, the state
  /// at load 0: the body at rest if nothing acts there.
  [[nodiscard]] Advance advance();

 protected:
  /// @return ended if nothing is left to do, or the result of Path::stop or accept
  [[nodiscard]] virtual Advance next() = 0;

  Path& path_;
};

}  // namespace peristat
