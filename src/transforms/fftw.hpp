#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

#include "src/core/types.hpp"

namespace peristat::fftw {

/// A plan of FFTW (fftw_plan), made and destroyed under one lock for the process.
class Plan {
 public:
  Plan() = default;
  /// @param make returns the plan; only estimated plans (FFTW_ESTIMATE) are the same in every run
  /// @throws std::logic_error for a null plan: arguments that FFTW does not support
  explicit Plan(const std::function<void*()>& make);

  [[nodiscard]] void* get() const { return plan_.get(); }

 private:
  struct Destroy {
    void operator()(void* plan) const;
  };
  std::unique_ptr<void, Destroy> plan_;
};

/// Memory with the alignment that FFTW needs, zero at first.
class Buffer {
 public:
  Buffer() = default;
  /// @throws std::bad_alloc
  explicit Buffer(std::size_t count);

  [[nodiscard]] double* data() const { return data_.get(); }
  [[nodiscard]] std::span<double> values() const { return {data_.get(), count_}; }

 private:
  struct Free {
    void operator()(double* data) const;
  };
  std::unique_ptr<double[], Free> data_;
  std::size_t count_ = 0;
};

/// A box of elements seen along one of its axes: `outer` planes, each of `inner` lines side by side
/// with `count` elements, `inner` apart.
struct Lines {
  Index outer = 1, count = 1, inner = 1;
};

/// Transforms along an axis of a box, line by line in batches that threads share. FFTW's own
/// threads are not used: estimated plans of theirs start dozens of small pieces of work, which on
/// busy cores takes ten times as long as the transform. So every number of threads gives the same
/// bits.
class AxisPass {
 public:
  /// Plans `lines` transforms of elements that are `stride` apart, in lines `distance` apart, all
  /// counted in elements.
  using Make = std::function<void*(int lines, int stride, int distance)>;
  /// Executes a plan for the element with this number and those after it.
  using Execute = std::function<void(void* plan, std::size_t element)>;

  AxisPass() = default;
  AxisPass(const Lines& lines, const Make& make);

  void execute(int threads, const Execute& execute) const;

 private:
  Lines lines_;
  Index batch_ = 1;   // lines of a batch
  Index across_ = 1;  // lines that are batched: rows of the box, or lines of a plane
  Plan whole_, rest_;
};

}  // namespace peristat::fftw
