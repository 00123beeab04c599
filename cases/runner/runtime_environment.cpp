#include "cases/runner/runtime_environment.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <sched.h>
#include <unistd.h>

namespace peristat {

namespace {

/// Value of a variable that holds a positive number, or 0.
int positive_variable(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::max(0, std::atoi(text)) : 0;
}

int processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 1;
  return std::max(1, CPU_COUNT(&allowed));
}

}  // namespace

int choose_threads(int asked_for) {
  int threads = asked_for > 0 ? asked_for : positive_variable("OMP_NUM_THREADS");
  if (threads == 0) threads = processors();
  const int limit = positive_variable("OMP_THREAD_LIMIT");
  return limit > 0 ? std::min(threads, limit) : threads;
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
  // Vectors of a large body go back to the system when they are freed: without a fixed threshold
  // what the neighbour search has used stays with its threads.
  setenv("MALLOC_MMAP_THRESHOLD_", "1048576", 0);
  if (!std::getenv("OMP_WAIT_POLICY")) setenv("GOMP_SPINCOUNT", "1000", 0);
  execv("/proc/self/exe", arguments);
  unsetenv(mark);  // no /proc: the program also runs as it is, only slower
}

}  // namespace peristat
