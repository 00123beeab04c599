#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace peristat {

/// Doubles at cache lines that nothing initialises: where they are never touched, a large buffer
/// takes addresses but no memory.
class RawBuffer {
 public:
  [[nodiscard]] double* data() { return values_.get(); }
  [[nodiscard]] const double* data() const { return values_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Makes room for at least so many numbers, which replace those before.
  void make_room(std::size_t count) {
    if (count <= size_) return;
    values_.reset();  // not beside the larger one
    values_.reset(static_cast<double*>(::operator new(count * sizeof(double), alignment)));
    size_ = count;
  }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Delete {
    void operator()(double* values) const { ::operator delete(values, alignment); }
  };

  std::unique_ptr<double, Delete> values_;
  std::size_t size_ = 0;
};

}  // namespace peristat
