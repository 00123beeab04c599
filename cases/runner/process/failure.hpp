#pragma once

#include <string>

#include "cases/runner/process/exit.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// How the program ends after an exception.
struct Failure {
  Exit code;
  std::string message;
};

/// Classifies the exception being handled: wrong input, too little memory, a fault of the machine,
/// or else a bug.
[[nodiscard]] Failure current_failure();

/// Lets the first of the failed ranks report the failure: ranks wait here, one longer than the
/// other, and the first ends the others while they wait.
void give_way_to_first(const Communicator& ranks);

}  // namespace peristat
