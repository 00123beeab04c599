#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

namespace peristat {

/// Basic operations on plain vectors, used by the solvers.

/// term(0) + … + term(count - 1), by sums that do not wait for one another.
template <class Term>
[[nodiscard]] double sum_of(std::size_t count, const Term& term) {
  constexpr std::size_t strip = 16;
  std::array<double, strip> sums{};
  const std::size_t whole = count - count % strip;
  for (std::size_t k = 0; k < whole; k += strip) {
#pragma omp simd
    for (std::size_t l = 0; l < strip; ++l) sums[l] += term(k + l);
  }
  for (std::size_t k = whole; k < count; ++k) sums[0] += term(k);
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

[[nodiscard]] inline double dot(std::span<const double> a, std::span<const double> b) {
  return sum_of(a.size(), [&](std::size_t k) { return a[k] * b[k]; });
}

/// 2-norm of entry(0), …, entry(count - 1). Where squares would underflow or overflow the entries
/// are scaled first: a residual must not vanish because it is small.
template <class Entry>
[[nodiscard]] double norm_of(std::size_t count, const Entry& entry) {
  const auto squares = [&](const auto& value_at) {
    return sum_of(count, [&](std::size_t k) {
      const double value = value_at(k);
      return value * value;
    });
  };
  const double plain = squares(entry);
  if (plain > 1e-280 && plain < 1e300) return std::sqrt(plain);
  double largest = 0.0;
  for (std::size_t k = 0; k < count; ++k) largest = std::max(largest, std::abs(entry(k)));
  if (largest == 0.0 || !std::isfinite(largest)) return std::sqrt(plain);
  return largest * std::sqrt(squares([&](std::size_t k) { return entry(k) / largest; }));
}

[[nodiscard]] inline double norm(std::span<const double> a) {
  return norm_of(a.size(), [&](std::size_t k) { return a[k]; });
}

/// to += factor * what
inline void add_scaled(std::span<double> to, double factor, std::span<const double> what) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * what[k];
}

}  // namespace peristat
