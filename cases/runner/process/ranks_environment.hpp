#pragma once

#include <string>
#include <vector>

namespace peristat {

/// True if this process was started as a rank, of several or of one: by mpirun, or by srun with
/// PMIx.
[[nodiscard]] bool is_started_as_rank();

/// Number of ranks on this machine according to mpirun; 1 if unknown.
[[nodiscard]] int ranks_on_machine();

/// Starts the program on `ranks` ranks by mpirun, even if there are fewer cores, and waits for
/// their end. Interruptions are passed on to them. A descriptor in PERISTAT_NOTE remains that of
/// this process. Prints their last words.
/// @param arguments of the program, without its name
/// @return exit code
/// @throws MachineError
[[nodiscard]] int run_as_ranks(int ranks, const std::vector<std::string>& arguments);

/// Prints what a rank says before it ends all ranks. run_as_ranks() prints it if it has started
/// them: mpirun drops output that it has not read by then. Otherwise the rank prints it on standard
/// error and leaves mpirun time to read.
void say_last_words(const std::string& text);

}  // namespace peristat
