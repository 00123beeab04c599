#pragma once

#include <string>
#include <vector>

namespace peristat {

/// Whether something has started this process as one of several ranks, or of one: mpirun, or srun
/// with PMIx.
[[nodiscard]] bool is_started_as_rank();

/// Ranks on this machine, as far as mpirun has told; at least 1.
[[nodiscard]] int ranks_on_machine();

/// Takes this process' place by mpirun, which starts the program as so many ranks; more than there
/// are cores if so many are asked for. The note that PERISTAT_NOTE asks for is still this process'.
/// @param arguments of the program, without its name
/// @throws MachineError if there is no mpirun
[[noreturn]] void start_as_ranks(int ranks, const std::vector<std::string>& arguments);

}  // namespace peristat
