#pragma once

#include <map>
#include <string>

#include "cases/runner/commands/run_company.hpp"
#include "cases/runner/input/case.hpp"
#include "cases/runner/process/exit.hpp"
#include "cases/runner/results/folder/earlier_run.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

struct RunOptions {
  int threads = 1;
  bool quiet = false;
  std::string log_file;
  bool overwrite = false;  ///< replaces an earlier run of another case in the folder, too
  int steps = 0;           ///< to accept before the run is interrupted; 0: all
  const RunCompany* company = nullptr;  ///< null: this process does nothing else
};

/// Versions of the program and of its libraries, for the results file and the version command.
[[nodiscard]] std::map<std::string, std::string> versions();

/// Runs a case and writes its results folder. On SIGINT, SIGTERM, SIGUSR1 and SIGHUP it closes the
/// results and returns `interrupted`. The folder's absolute path is written to the file that the
/// environment variable PERISTAT_NOTE names, for the launcher. Collective.
/// @param ranks   that have a part of the body each; rank 0 prints and writes for all. The exit
///                code is the same on all
/// @param earlier run to resume: of the same case, or of one that this one extends
/// @throws InputError, MemoryError before anything is written
/// @throws what a given function throws, after the results are closed as failed
/// @throws MachineError if the machine fails, std::bad_alloc if the memory does: every accepted
///         step is kept, and the summary says "failed" if it can be written. In company also any
///         other exception, of its callbacks, too. With several ranks
///         perhaps on one alone: the others must be ended then (Communicator::abort)
[[nodiscard]] Exit run(const Case& from, const RunOptions& options, const Communicator& ranks,
                       EarlierRun* earlier = nullptr);

}  // namespace peristat
