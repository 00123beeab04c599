#pragma once

#include <cstdint>

namespace peristat {

/// Costs of a run, in all its sessions.
struct RunCosts {
  std::int64_t factorisations = 0, linear_iterations = 0;
  /// Wall times [s].
  struct Seconds {
    double total = 0, neighbourhood = 0, assembly = 0, linear = 0, relaxation = 0, output = 0,
           checkpoints = 0;  ///< part of output
  } seconds;
};

}  // namespace peristat
