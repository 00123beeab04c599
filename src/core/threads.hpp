#pragma once

#include <algorithm>
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

/// Calls body(part) for the parts of a thread: of all parts a share of successive ones.
template <class Body>
void for_parts_of_thread(int thread, int threads, int parts, const Body& body) {
  const int last = parts * (thread + 1) / threads;
  for (int part = parts * thread / threads; part < last; ++part) body(part);
}

/// Runs body(part) for all parts, on at most so many threads.
/// @throws ThreadError
template <class Body>
void run_on_parts(int threads, int parts, const Body& body) {
  const int busy = std::min(threads, parts);
  run_on_threads(busy, [&](int thread) { for_parts_of_thread(thread, busy, parts, body); });
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
