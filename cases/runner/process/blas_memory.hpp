#pragma once

namespace peristat {

/// Takes the memory that OpenBLAS works in, and starts the threads, while there is room for both.
/// OpenBLAS asks for a buffer per thread, and one more, when it first needs them, and if it gets
/// none it asks for ever; OpenMP ends the program if it gets no thread.
///
/// OpenBLAS takes a part of this memory when it is loaded, before main. A program with this
/// function therefore checks for that room earlier still, and ends with exit code 4 if there is
/// none.
/// @throws std::bad_alloc if there is too little address space (`ulimit -v`)
/// @throws MachineError if the system gives no more threads
void claim_blas_memory(int threads);

}  // namespace peristat
