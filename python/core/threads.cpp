#include "python/core/threads.hpp"

#include "cases/runner/process/blas_memory.hpp"
#include "cases/runner/process/runtime_environment.hpp"
#include "src/core/input_error.hpp"
#include "src/core/threads.hpp"

namespace peristat::python {

int prepare_threads(int asked_for) {
  if (asked_for < 0) throw InputError("threads", std::to_string(asked_for), "must be at least 1");
  try {
    const int threads = choose_threads(asked_for);
    require_threads(threads);
    claim_blas_memory(threads);
    return threads;
  } catch (const InputError& error) {
    throw InputError("threads", error.value(), error.allowed());
  }
}

}  // namespace peristat::python
