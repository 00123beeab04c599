#include "src/transforms/fftw.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>

#include <fftw3.h>

namespace peristat::fftw {
namespace {

std::mutex& planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Planner::Planner(int threads) : hold_(planner_mutex()) {
  static const bool has_threads = fftw_init_threads() != 0;
  if (has_threads) fftw_plan_with_nthreads(threads);
}

Plan::Plan(void* plan) : plan_(plan) {
  if (plan == nullptr) throw std::logic_error("FFTW has no plan for such a transform");
}

void Plan::execute() const { fftw_execute(static_cast<fftw_plan>(plan_.get())); }

void Plan::Destroy::operator()(void* plan) const {
  const std::lock_guard hold(planner_mutex());
  fftw_destroy_plan(static_cast<fftw_plan>(plan));
}

Buffer::Buffer(std::size_t count) : data_(fftw_alloc_real(count)), count_(count) {
  if (count > 0 && !data_) throw std::bad_alloc();
  std::fill_n(data_.get(), count, 0.0);
}

void Buffer::Free::operator()(double* data) const { fftw_free(data); }

}  // namespace peristat::fftw
