#include "src/transforms/fftw.hpp"

#include <algorithm>
#include <mutex>
#include <new>
#include <stdexcept>

#include <fftw3.h>

namespace peristat::fftw {
namespace {

/// Lines that are transformed together: two cache lines of doubles side by side.
constexpr Index lines_of_batch = 16;

/// FFTW has one planner for the process, and calls of it must not overlap.
std::mutex& planner() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Plan::Plan(const std::function<void*()>& make) {
  const std::lock_guard hold(planner());
  plan_.reset(make());
  if (!plan_) throw std::logic_error("FFTW has no plan for such a transform");
}

void Plan::Destroy::operator()(void* plan) const {
  const std::lock_guard hold(planner());
  fftw_destroy_plan(static_cast<fftw_plan>(plan));
}

Buffer::Buffer(std::size_t count) : data_(fftw_alloc_real(count)), count_(count) {
  if (count > 0 && !data_) throw std::bad_alloc();
  std::fill_n(data_.get(), count, 0.0);
}

void Buffer::Free::operator()(double* data) const { fftw_free(data); }

AxisPass::AxisPass(const Lines& lines, const Make& make) : lines_(lines) {
  const bool are_rows = lines.inner == 1;
  across_ = are_rows ? lines.outer : lines.inner;
  batch_ = std::min(lines_of_batch, across_);
  const int stride = lines.inner, distance = are_rows ? lines.count : 1;
  whole_ = Plan([&] { return make(batch_, stride, distance); });
  const Index rest = across_ % batch_;
  if (rest > 0) rest_ = Plan([&] { return make(rest, stride, distance); });
}

void AxisPass::execute(int threads, const Execute& execute) const {
  const bool are_rows = lines_.inner == 1;
  const Offset batches = (across_ + batch_ - 1) / batch_;
  const Offset all = are_rows ? batches : batches * lines_.outer;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (Offset k = 0; k < all; ++k) {
    const Offset first = k % batches * batch_;
    const Offset plane = k / batches * lines_.count * lines_.inner;
    execute((first + batch_ <= across_ ? whole_ : rest_).get(),
            std::size_t(plane + first * (are_rows ? lines_.count : 1)));
  }
}

}  // namespace peristat::fftw
