#pragma once

#include "src/potentials/harmonic.hpp"

namespace peristat {

/// Bond that softens between the stretches s_m and s_c (eq. 12 of [ADAPT]):
///
///   T(s) = 1/2 [1 - tanh(beta (s_m + s_c - 2 s)/(s_m - s_c))] = 1/(1 + exp y),
///   y = 2 beta (2 s - s_m - s_c)/(s_c - s_m)   for s_m < s < s_c, 1 below, 0 above.
///
/// As published T jumps by (1 - tanh beta)/2 at both ends (0.00247 for beta = 3); the continuous
/// form is (T - T(s_c)) / (T(s_m) - T(s_c)), from 1 to 0 without a jump. dT/ds is negative, so the
/// claim of [ADAPT] sec. 2.4 that the tangent stays positive definite fails as soon as s T(s) has
/// passed its peak, shortly after s_m.
struct TanhDegradation {
  double onset_stretch = 0.0;     ///< s_m
  double critical_stretch = 0.0;  ///< s_c > s_m
  double rate = 3.0;              ///< beta > 0
  double scale = 1.0;             ///< T is scale / (1 + exp y) + shift
  double shift = 0.0;

  /// The form without jumps.
  [[nodiscard]] static TanhDegradation continuous(double onset, double critical, double rate);

  [[nodiscard]] double onset() const { return onset_stretch; }
  [[nodiscard]] double critical() const { return critical_stretch; }
  [[nodiscard]] double integrity(double s) const;
  [[nodiscard]] double slope(double s) const;

  /// For the modulus 1, in closed form: with a = (s_c - s_m)/(4 beta) and s = s_mid + a y,
  ///   int s/(1 + exp y) ds = a s_mid F_1(y) + a^2 F_2(y),
  ///   F_1 = -ln(1 + exp(-y)),  F_2 = -y ln(1 + exp(-y)) + Li_2(-exp(-y)).
  [[nodiscard]] double work(const Harmonic& whole, double s) const;

  /// The same law between other stretches.
  [[nodiscard]] TanhDegradation between(double onset, double critical) const {
    return {onset, critical, rate, scale, shift};
  }

 private:
  [[nodiscard]] double exponent(double s) const;
  [[nodiscard]] double primitive(double y) const;
};

}  // namespace peristat
