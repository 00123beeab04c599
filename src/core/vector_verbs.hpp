#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace peristat {

/// Basic operations on plain vectors, used by the solvers.

[[nodiscard]] inline double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// 2-norm of entry(0), …, entry(count - 1). Where squares would underflow or overflow the entries
/// are scaled first: a residual must not vanish because it is small.
template <class Entry>
[[nodiscard]] double norm_of(std::size_t count, const Entry& entry) {
  double squared = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double value = entry(k);
    squared += value * value;
    largest = std::max(largest, std::abs(value));
  }
  const bool is_safe = squared > 1e-280 && squared < 1e300;
  if (is_safe || largest == 0.0 || !std::isfinite(largest)) return std::sqrt(squared);
  squared = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double share = entry(k) / largest;
    squared += share * share;
  }
  return largest * std::sqrt(squared);
}

[[nodiscard]] inline double norm(std::span<const double> a) {
  return norm_of(a.size(), [&](std::size_t k) { return a[k]; });
}

/// to += factor * what
inline void add_scaled(std::span<double> to, double factor, std::span<const double> what) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * what[k];
}

}  // namespace peristat
