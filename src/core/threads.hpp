#pragma once

#include <string>

#include <omp.h>

#include "src/core/machine_error.hpp"

namespace peristat {

/// The system runs fewer threads than were asked for.
class ThreadError : public MachineError {
 public:
  ThreadError(int granted, int asked_for)
      : MachineError("the system runs " + std::to_string(granted) + " of " +
                     std::to_string(asked_for) +
                     " threads; ask for fewer (--threads, OMP_NUM_THREADS)") {}
};

/// Runs body(thread) on exactly so many threads, each with the share of the work that belongs to
/// its number. OpenMP may grant fewer threads than a parallel region requests (OMP_DYNAMIC, a
/// nested region), and the shares of the missing ones would silently be left out.
/// @throws ThreadError; body has then not run
template <class Body>
void run_on_threads(int threads, const Body& body) {
  int granted = threads;
#pragma omp parallel num_threads(threads)
  {
    if (omp_get_num_threads() == threads) {
      body(omp_get_thread_num());
    } else {
#pragma omp master
      granted = omp_get_num_threads();
    }
  }
  if (granted != threads) throw ThreadError(granted, threads);
}

/// Makes sure that later parallel regions get so many threads, whatever OMP_DYNAMIC and
/// OMP_MAX_ACTIVE_LEVELS say.
/// @throws ThreadError
inline void require_threads(int threads) {
  omp_set_dynamic(0);
  omp_set_max_active_levels(1);
  run_on_threads(threads, [](int) {});
}

}  // namespace peristat
