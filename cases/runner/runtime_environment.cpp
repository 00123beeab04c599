#include "cases/runner/runtime_environment.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <sched.h>
#include <unistd.h>

namespace peristat {

int default_threads() {
  if (const char* wanted = std::getenv("OMP_NUM_THREADS")) {
    const int threads = std::atoi(wanted);
    if (threads > 0) return threads;
  }
  cpu_set_t processors;
  CPU_ZERO(&processors);
  if (sched_getaffinity(0, sizeof processors, &processors) != 0) return 1;
  return std::max(1, CPU_COUNT(&processors));
}

void restart_with_environment(int threads, char** arguments) {
  constexpr const char* mark = "PERISTAT_ENVIRONMENT_SET";
  if (std::getenv(mark)) {
    unsetenv(mark);
    return;
  }
  setenv(mark, "1", 1);
  const std::string count = std::to_string(threads);
  setenv("OMP_THREAD_LIMIT", count.c_str(), 0);
  setenv("OMP_NUM_THREADS", count.c_str(), 1);
  setenv("OMP_WAIT_POLICY", "passive", 0);
  execv("/proc/self/exe", arguments);
  unsetenv(mark);  // no /proc: the program also runs as it is, only slower
}

}  // namespace peristat
