#pragma once

#include <string>

#include "cases/runner/case.hpp"

namespace peristat {

/// Exit codes of the program.
enum class Exit : int {
  done = 0,
  bug = 1,
  wrong_input = 2,
  not_converged = 3,
  out_of_memory = 4,
  interrupted = 130,
};

struct RunOptions {
  int threads = 1;
  bool quiet = false;
  std::string log_file;
};

/// Versions of the program and of its libraries, for the results file and the version command.
[[nodiscard]] std::map<std::string, std::string> versions();

/// Runs a case and writes its results folder; follows SIGINT and SIGTERM by closing the results and
/// returning `interrupted`. The folder's absolute path is written to the file that the environment
/// variable PERISTAT_NOTE names, for the launcher.
/// @throws InputError, MemoryError before anything is written
[[nodiscard]] Exit run(const Case& from, const RunOptions& options);

}  // namespace peristat
