#pragma once

namespace peristat {

/// Opens /dev/null in place of each standard stream that the program was started without: otherwise
/// the first results file would get its descriptor, and the printed messages.
/// @throws MachineError if there is no /dev/null
void open_standard_streams();

/// Threads to use: those asked for on the command line (0 if none were), else OMP_NUM_THREADS, else
/// the processors that this process may run on; never more than OMP_THREAD_LIMIT, beyond which
/// OpenBLAS would wait for ever for threads that it does not get, and from OMP_NUM_THREADS never
/// more than there are processors.
/// @throws InputError (key "--threads") if more are asked for than most_threads
[[nodiscard]] int choose_threads(int asked_for);

/// Largest number that --threads and --ranks accept: 4 per processor, and at least 16. More would
/// only take memory.
[[nodiscard]] int most_threads();

/// @throws InputError (key "--ranks") if more than most_threads are to be started here
void require_room_for_ranks(int asked_for);

/// Restarts the program once with the environment that its libraries read only while they are
/// loaded:
///  - OMP_NUM_THREADS = OMP_THREAD_LIMIT = threads: CHOLMOD's own loops ask for a fixed number of
///    threads, and nothing else bounds them.
///  - GOMP_SPINCOUNT: threads of OpenBLAS and of this program wait actively for microseconds.
///    Waiting in the kernel at once (OMP_WAIT_POLICY=passive) makes a small factorisation twice as
///    slow on two threads as on one; waiting actively for longer makes it hang when another program
///    wants the core.
///  - GLIBC_TUNABLES: memory is asked for in huge pages, where the system leaves the choice to
///    programs. A path with a direct solver gains 7 %.
///  - MALLOC_MMAP_THRESHOLD_: see keep_freed_memory_of_small_bodies.
/// What the user has set of the last three is kept. Returns in the restarted program, or if it
/// can't be restarted.
void restart_with_environment(int threads, char** arguments);

/// Chooses what becomes of the memory of freed vectors. In a small body it stays with the process:
/// steps are quick, and the system would take a tenth of the time of a path to give it out again.
/// In a large one it goes back to the system, which saves 4 % of the peak. Does nothing if the user
/// has set MALLOC_MMAP_THRESHOLD_.
void keep_freed_memory_of_small_bodies(bool is_small);

}  // namespace peristat
