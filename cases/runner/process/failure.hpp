#pragma once

#include <string>

#include "cases/runner/process/exit.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// How the program ends after an exception.
struct Failure {
  Exit code;
  std::string message;
};

/// Of the exception that is being handled: wrong input, too little memory, a fault of the machine,
/// and a bug where it is none of these.
[[nodiscard]] Failure current_failure();

/// Lets the first of the ranks that have met a failure tell it: it ends the others while they wait
/// here, rank after rank.
void give_way_to_first(const Communicator& ranks);

}  // namespace peristat
