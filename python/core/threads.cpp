#include "python/core/threads.hpp"

#include <cstdlib>
#include <future>
#include <thread>

#include <omp.h>
#include <pthread.h>
#include <unistd.h>

#include "cases/runner/process/blas_memory.hpp"
#include "cases/runner/process/runtime_environment.hpp"
#include "src/core/input_error.hpp"
#include "src/core/threads.hpp"

namespace peristat::python {
namespace {

/// Lets threads of OpenMP that wait do so for microseconds before they sleep, not for milliseconds,
/// in which other programs could work. The program restarts itself with GOMP_SPINCOUNT for that; in
/// Python, NumPy may have loaded OpenMP before. OpenMP has the same rule where there are more
/// threads than processors: an idle team sees to that.
void shorten_waiting() {
  if (std::getenv("GOMP_SPINCOUNT") != nullptr || std::getenv("OMP_WAIT_POLICY") != nullptr) return;
  std::promise<void> begun;
  std::thread([&begun] {
#pragma omp parallel num_threads(omp_get_num_procs() + 1)
    {}
    begun.set_value();
    pause();  // for ever: its team ends with it
  }).detach();
  begun.get_future().wait();
}

/// Lets processes that Python forks work, too: they would wait for ever for threads of OpenMP,
/// which stay behind. Without threads before the fork, both processes start theirs anew.
void end_threads_before_forks() {
  pthread_atfork([] { omp_pause_resource_all(omp_pause_soft); }, nullptr, nullptr);
}

}  // namespace

int prepare_threads(int asked_for) {
  if (asked_for < 0) throw InputError("threads", std::to_string(asked_for), "must be at least 1");
  try {
    const int threads = choose_threads(asked_for);
    require_threads(threads);
    claim_blas_memory(threads);
    [[maybe_unused]] static const bool is_prepared =
        (shorten_waiting(), end_threads_before_forks(), true);
    return threads;
  } catch (const InputError& error) {
    throw InputError("threads", error.value(), error.allowed());
  }
}

}  // namespace peristat::python
