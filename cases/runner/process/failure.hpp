#pragma once

#include <string>

#include "cases/runner/process/exit.hpp"

namespace peristat {

/// How the program ends after an exception.
struct Failure {
  Exit code;
  std::string message;
};

/// Of the exception that is being handled: wrong input, too little memory, a fault of the machine,
/// and a bug where it is none of these.
[[nodiscard]] Failure current_failure();

}  // namespace peristat
