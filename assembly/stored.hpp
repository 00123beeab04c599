#pragma once

namespace peristat {

/// What a pass over the interactions finds besides what it adds up.
struct Stored {
  double energy = 0.0;      ///< [J]
  bool degenerate = false;  ///< a measure without gradient at zero has reached it, or a value is
                            ///< not finite: reject the state
};

}  // namespace peristat
