#pragma once

#include <stdexcept>

namespace peristat {

/// The machine failed a run that was right: disk full, folder gone, a limit of the shell (exit
/// code 5). Says what failed and the system's reason.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace peristat
