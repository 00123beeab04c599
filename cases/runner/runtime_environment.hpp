#pragma once

namespace peristat {

/// Threads to use if the command line does not say: OMP_NUM_THREADS, else the processors that this
/// process may run on.
[[nodiscard]] int default_threads();

/// Restarts the program once with the environment that its libraries read only while they are
/// loaded:
///  - OMP_THREAD_LIMIT = threads: CHOLMOD's own loops ask for a fixed number of threads, and
///  nothing
///    else bounds them.
///  - OMP_WAIT_POLICY = passive: threads of OpenBLAS and ours that wait must not take the cores
///  from
///    those that work.
/// Variables that the person has set are left alone. Returns if nothing is to be changed.
void restart_with_environment(int threads, char** arguments);

}  // namespace peristat
