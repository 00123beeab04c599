#pragma once

namespace peristat {

/// Exit codes of the program.
enum class Exit : int {
  done = 0,
  bug = 1,
  wrong_input = 2,
  not_converged = 3,
  out_of_memory = 4,
  machine_failed = 5,
  interrupted = 130,
};

}  // namespace peristat
