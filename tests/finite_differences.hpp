#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace peristat::tests {

/// A function along a line, t -> f(x + t v): its values, flattened.
using AlongLine = std::function<std::vector<double>(double)>;

namespace difference_detail {

inline double norm(const std::vector<double>& a) {
  double squared = 0.0;
  for (double entry : a) squared += entry * entry;
  return std::sqrt(squared);
}

/// Distance of the central difference of step h from the derivative.
inline double error(const AlongLine& f, const std::vector<double>& derivative, double h) {
  const std::vector<double> ahead = f(h), behind = f(-h);
  std::vector<double> distance(derivative.size());
  for (std::size_t k = 0; k < distance.size(); ++k) {
    distance[k] = (ahead[k] - behind[k]) / (2.0 * h) - derivative[k];
  }
  return norm(distance);
}

}  // namespace difference_detail

/// Asserts that `derivative` is df/dt at t = 0: the error of the central difference falls with the
/// square of its step (order 2 +- 0.1), and is small. A wrong derivative leaves an error that does
/// not fall (order 0), however small it is.
///
/// Where f is a polynomial of degree two or less, the central difference is exact: its error must
/// then be round-off at a step that is not small.
///
/// @param step largest step; a thousandth of the scale on which f bends keeps both the truncation
///        (1e-6 of the derivative) and the round-off (1e-13 of f per step) apart
inline ::testing::AssertionResult is_derivative(const AlongLine& f,
                                                const std::vector<double>& derivative,
                                                double step) {
  using namespace difference_detail;
  const double size = norm(derivative);
  const std::vector<double> value = f(0.0);
  if (value.empty() || value.size() != derivative.size()) {
    return ::testing::AssertionFailure()
           << value.size() << " values, " << derivative.size() << " derivatives";
  }
  if (!(size > 0.0)) return ::testing::AssertionFailure() << "the derivative is " << size;

  const double coarse = error(f, derivative, step), fine = error(f, derivative, 0.5 * step);
  // Values carry some hundred round-offs each (sums over bonds).
  const double scale = std::max({norm(value), norm(f(step)), norm(f(-step))});
  const double round_off = 100.0 * std::numeric_limits<double>::epsilon() * scale / step;
  if (round_off > 1e-8 * size) {
    return ::testing::AssertionFailure() << "step " << step << " drowns in round-off";
  }
  if (coarse <= round_off) return ::testing::AssertionSuccess() << "exact up to round-off";
  const double order = std::log2(coarse / fine);
  if (std::abs(order - 2.0) <= 0.1 && coarse <= 1e-4 * size) {
    return ::testing::AssertionSuccess() << "order " << order;
  }
  return ::testing::AssertionFailure()
         << "order " << order << ", relative error " << coarse / size << " at step " << step
         << " and " << fine / size << " at half of it";
}

}  // namespace peristat::tests
