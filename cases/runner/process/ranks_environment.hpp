#pragma once

#include <string>
#include <vector>

namespace peristat {

/// Whether something has started this process as one of several ranks, or of one: mpirun, or srun
/// with PMIx.
[[nodiscard]] bool is_started_as_rank();

/// Ranks on this machine, as far as mpirun has told; at least 1.
[[nodiscard]] int ranks_on_machine();

/// Has mpirun start the program as so many ranks, more than there are cores if so many are asked
/// for, and waits for their end. Interruptions are passed on to them; the note that PERISTAT_NOTE
/// asks for is still this process'.
/// @param arguments of the program, without its name
/// @return exit code
/// @throws MachineError
[[nodiscard]] int run_as_ranks(int ranks, const std::vector<std::string>& arguments);

}  // namespace peristat
