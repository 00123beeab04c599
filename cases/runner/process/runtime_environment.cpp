#include "cases/runner/process/runtime_environment.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <malloc.h>
#include <sched.h>
#include <unistd.h>

#include "cases/runner/process/processors.hpp"
#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {

namespace {

/// Value of a variable that holds a positive number, or 0.
int positive_variable(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::max(0, std::atoi(text)) : 0;
}

}  // namespace

void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    // The lowest free descriptor is this one, as those below it are open.
    if (open("/dev/null", O_RDWR) != stream) {
      throw MachineError(
          std::string("a standard stream is closed, and /dev/null can't be opened: ") +
          std::strerror(errno));
    }
  }
}

int most_threads() { return std::max(16, 4 * processors()); }

int choose_threads(int asked_for) {
  if (asked_for > most_threads()) {
    throw InputError("--threads", std::to_string(asked_for),
                     "at most " + std::to_string(most_threads()) + " on this machine, which has " +
                         std::to_string(processors()) + " processors");
  }
  int threads = asked_for;
  if (threads == 0) threads = std::min(positive_variable("OMP_NUM_THREADS"), processors());
  if (threads == 0) threads = processors();
  const int limit = positive_variable("OMP_THREAD_LIMIT");
  return limit > 0 ? std::min(threads, limit) : threads;
}

void require_room_for_ranks(int asked_for) {
  if (asked_for <= most_threads()) return;
  throw InputError("--ranks", std::to_string(asked_for),
                   "at most " + std::to_string(most_threads()) + " on this machine, which has " +
                       std::to_string(processors()) +
                       " processors; on several machines mpirun or srun starts them");
}

namespace {

/// Freed blocks of at least this size go back to the system.
constexpr int released_bytes = 1 << 20;

}  // namespace

void keep_freed_memory_of_small_bodies(bool is_small) {
  const char* const set = std::getenv("MALLOC_MMAP_THRESHOLD_");
  if (set && set != std::to_string(released_bytes)) return;
  constexpr int most_of_glibc = 1 << 25;  // of M_MMAP_THRESHOLD
  mallopt(M_MMAP_THRESHOLD, is_small ? most_of_glibc : released_bytes);
  mallopt(M_TRIM_THRESHOLD, is_small ? 1 << 28 : 1 << 17);  // the latter is glibc's
}

void restart_with_environment(int threads, char** arguments) {
  constexpr const char* mark = "PERISTAT_ENVIRONMENT_SET";
  if (std::getenv(mark)) {
    unsetenv(mark);
    return;
  }
  setenv(mark, "1", 1);
  const std::string count = std::to_string(threads);
  setenv("OMP_NUM_THREADS", count.c_str(), 1);
  setenv("OMP_THREAD_LIMIT", count.c_str(), 1);
  // With a fixed threshold, vectors of a large body go back to the system when they are freed.
  // Without it, the memory of the neighbour search stays with its threads.
  setenv("MALLOC_MMAP_THRESHOLD_", std::to_string(released_bytes).c_str(), 0);
  // Huge pages, where the system leaves the choice to programs, save misses in tables of pages.
  setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
  if (!std::getenv("OMP_WAIT_POLICY")) setenv("GOMP_SPINCOUNT", "1000", 0);
  execv("/proc/self/exe", arguments);
  unsetenv(mark);  // no /proc: the program also runs as it is, only slower
}

}  // namespace peristat
