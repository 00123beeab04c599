#pragma once

#include <cstdint>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// Weibull's distribution with the mean 1: a factor f is below x with the probability
///
///   P = 1 - exp(-(x Gamma(1 + 1/m))^m),
///
/// so that its coefficient of variation is sqrt(Gamma(1 + 2/m)/Gamma(1 + 1/m)^2 - 1), 0.120 for m =
/// 10. A field of correlation length l is that of a Gaussian field g with the covariance
///
///   <g(x) g(y)> = exp(-|x - y|^2 / l^2),
///
/// mapped by the distributions, P(f) = Phi(g); with l = 0 every place has a value of its own.
struct WeibullField {
  double modulus = 10.0;            ///< m
  double correlation_length = 0.0;  ///< l [m]
  std::uint64_t seed = 1;
};

/// The field at the points. A value depends on the field and the point's place alone, not on the
/// other points, their order or the threads; fields of the same seed and correlation length have
/// the same g. g is a sum of Fourier modes, sqrt(2/N) sum_n cos(k_n x + phi_n), with normal wave
/// vectors k_n (variance 2/l^2 per component) and uniform phases: its covariance over a large body
/// differs from the above by about 1/sqrt(N).
[[nodiscard]] std::vector<double> values_at(const Points& points, const WeibullField& field,
                                            int threads);

/// N
inline constexpr int fourier_modes = 1024;

}  // namespace peristat
