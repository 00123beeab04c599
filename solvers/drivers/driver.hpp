#pragma once

#include "solvers/drivers/path.hpp"

namespace peristat {

/// What steps a state along a path: by steps of the load today. It keeps nothing of its own between
/// two calls that is not in the path's state, so that another driver of the same kind can go on
/// from a copy of that.
class Driver {
 public:
  explicit Driver(Path& path) : path_(path) {}
  virtual ~Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// Takes the next step, or the decision that stands in its way. The first is step 0, the state at
  /// load 0: the body at rest where nothing acts there.
  [[nodiscard]] Advance advance();

 protected:
  /// @return ended where nothing is left to do, or whatever Path::stop or accept return
  [[nodiscard]] virtual Advance next() = 0;

  Path& path_;
};

}  // namespace peristat
