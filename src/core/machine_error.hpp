#pragma once

#include <stdexcept>

namespace peristat {

/// Failure of the machine in a correct run: disk full, folder gone, a limit of the shell (exit code
/// 5). Gives what failed and the system's reason.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace peristat
