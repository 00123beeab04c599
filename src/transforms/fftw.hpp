#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>

namespace peristat::fftw {

/// FFTW's planner is one for the process: whoever plans holds it, and has it plan for so many
/// threads.
class Planner {
 public:
  explicit Planner(int threads);

 private:
  std::unique_lock<std::mutex> hold_;
};

/// A plan of FFTW (fftw_plan), destroyed under the planner's lock.
class Plan {
 public:
  Plan() = default;
  /// @throws std::logic_error for a null plan: arguments that FFTW does not know
  explicit Plan(void* plan);

  void execute() const;

 private:
  struct Destroy {
    void operator()(void* plan) const;
  };
  std::unique_ptr<void, Destroy> plan_;
};

/// Aligned as FFTW likes it, zeros at first.
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

}  // namespace peristat::fftw
