#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace peristat {

/// The few verbs on plain vectors that the solvers speak.

[[nodiscard]] inline double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

[[nodiscard]] inline double norm(std::span<const double> a) { return std::sqrt(dot(a, a)); }

/// to += factor * what
inline void add_scaled(std::span<double> to, double factor, std::span<const double> what) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * what[k];
}

}  // namespace peristat
