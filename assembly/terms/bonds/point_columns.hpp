#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "src/core/aligned_vector.hpp"
#include "src/core/lanes.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Vectors of consecutive points, one array per component: a batch of lanes reads those of
/// consecutive points at once. Lanes past the last point may be read, and zeros added to them.
class PointColumns {
 public:
  PointColumns() = default;
  PointColumns(int components, Index points)
      : stride_(staggered(std::size_t(points) + SingleLanes::count)),
        values_(std::size_t(components) * stride_, 0.0) {}

  /// Point of the first entry from now on.
  void start_at(Index first) { first_ = first; }

  /// Component of the vectors, by point.
  [[nodiscard]] double* operator[](int component) {
    return values_.data() + std::size_t(component) * stride_ - std::ptrdiff_t(first_);
  }
  [[nodiscard]] const double* operator[](int component) const {
    return values_.data() + std::size_t(component) * stride_ - std::ptrdiff_t(first_);
  }

  void clear() { std::fill(values_.begin(), values_.end(), 0.0); }

 private:
  /// A length of columns whose components fall on different lines of the cache.
  static std::size_t staggered(std::size_t length) {
    constexpr std::size_t page = 512, shift = 88;  // doubles
    return (length + page - 1) / page * page + shift;
  }

  Index first_ = 0;
  std::size_t stride_ = 0;
  AlignedVector<double> values_;
};

}  // namespace peristat
