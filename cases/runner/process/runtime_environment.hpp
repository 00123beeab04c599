#pragma once

namespace peristat {

/// Opens /dev/null in place of each standard stream that the program was started without:
/// otherwise the first results file would get its descriptor, and what is told.
/// @throws MachineError if there is no /dev/null
void open_standard_streams();

/// Threads to use: those asked for on the command line (0 if none were), else OMP_NUM_THREADS, else
/// the processors that this process may run on; never more than OMP_THREAD_LIMIT, beyond which
/// OpenBLAS would wait for ever for threads that it does not get, and from OMP_NUM_THREADS never
/// more than there are processors.
/// @throws InputError (key "--threads") if more are asked for than most_threads
[[nodiscard]] int choose_threads(int asked_for);

/// What --threads and --ranks may ask for: 4 per processor, and 16 on any machine. More only take
/// memory.
[[nodiscard]] int most_threads();

/// @throws InputError (key "--ranks") if more are to be started here than most_threads
void require_room_for_ranks(int asked_for);

/// Restarts the program once with the environment that its libraries read only while they are
/// loaded:
///  - OMP_NUM_THREADS = OMP_THREAD_LIMIT = threads: CHOLMOD's own loops ask for a fixed number of
///    threads, and nothing else bounds them.
///  - GOMP_SPINCOUNT: threads of OpenBLAS and ours wait for their next turn for microseconds.
///  Waiting
///    in the kernel at once (OMP_WAIT_POLICY=passive) makes a small factorisation twice as slow on
///    two threads as on one, waiting actively makes it hang for long when another program wants the
///    core.
/// A waiting policy that the person has set is left alone. Returns if nothing is to be changed.
void restart_with_environment(int threads, char** arguments);

}  // namespace peristat
