#pragma once

namespace peristat::python {

/// Prepares the process for work with this number of threads; 0: OMP_NUM_THREADS, else all
/// processors.
/// @return the number of threads
/// @throws InputError for more than the machine may have, MachineError if it does not provide them
int prepare_threads(int asked_for);

}  // namespace peristat::python
