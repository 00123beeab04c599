#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace peristat {

/// Numbers below 65536, one per bond: in a byte each until one does not fit, then in two.
class KindNumbers {
 public:
  [[nodiscard]] std::uint16_t operator[](std::size_t k) const {
    return are_wide_ ? wide_[k] : narrow_[k];
  }
  [[nodiscard]] std::size_t size() const { return are_wide_ ? wide_.size() : narrow_.size(); }
  [[nodiscard]] std::size_t bytes_per_number() const { return are_wide_ ? 2 : 1; }

  [[nodiscard]] std::size_t capacity() const {
    return are_wide_ ? wide_.capacity() : narrow_.capacity();
  }
  void reserve(std::size_t numbers) {
    if (are_wide_) {
      wide_.reserve(numbers);
    } else {
      narrow_.reserve(numbers);
    }
  }
  void push_back(std::uint16_t number) {
    if (!are_wide_ && number > std::numeric_limits<std::uint8_t>::max()) widen();
    if (are_wide_) {
      wide_.push_back(number);
    } else {
      narrow_.push_back(static_cast<std::uint8_t>(number));
    }
  }
  void copy(std::size_t from, std::size_t to) {
    if (are_wide_) {
      wide_[to] = wide_[from];
    } else {
      narrow_[to] = narrow_[from];
    }
  }
  /// Keeps the first `count` numbers.
  void truncate(std::size_t count) {
    if (are_wide_) {
      wide_.resize(count);
    } else {
      narrow_.resize(count);
    }
  }

 private:
  void widen() {
    wide_.reserve(narrow_.capacity());
    wide_.assign(narrow_.begin(), narrow_.end());
    narrow_ = {};
    are_wide_ = true;
  }

  bool are_wide_ = false;
  std::vector<std::uint8_t> narrow_;
  std::vector<std::uint16_t> wide_;
};

}  // namespace peristat
