#pragma once

#include "src/potentials/harmonic.hpp"

namespace peristat {

/// Bond whose force c f(s) has a form that tests show: linear up to the onset s_m, with a lower
/// slope h up to the peak s_p, and from there down to zero at the critical stretch s_c,
///
///   f(s) = s                          s <= s_m
///          s_m + h (s - s_m)          s_m < s <= s_p,   f_p = f(s_p)
///          f_p g(x)                   s_p < s < s_c,    x = (s - s_p)/(s_c - s_p)
///          0                          s_c <= s
///   g(x) = (exp(-a x) - exp(-a))/(1 - exp(-a)), which is 1 - x for a = 0,
///
/// without a jump anywhere. T = f/s. With s_p = s_m the force falls from the onset on: linearly, or
/// for a > 0 the steeper at first the larger a is.
struct ForceEnvelope {
  double onset_stretch = 0.0;     ///< s_m > 0
  double critical_stretch = 0.0;  ///< s_c > s_p
  double decay = 0.0;             ///< a >= 0
  double rise = 0.0;              ///< (s_p - s_m)/(s_c - s_m), from 0 to below 1
  double hardening = 0.0;         ///< h, from 0 to below 1

  [[nodiscard]] double onset() const { return onset_stretch; }
  [[nodiscard]] double critical() const { return critical_stretch; }
  [[nodiscard]] double integrity(double s) const;
  [[nodiscard]] double slope(double s) const;

  /// For the modulus 1, in closed form.
  [[nodiscard]] double work(const Harmonic& whole, double s) const;

  /// The same law between other stretches.
  [[nodiscard]] ForceEnvelope between(double onset, double critical) const {
    return {onset, critical, decay, rise, hardening};
  }

  [[nodiscard]] double peak() const {
    return onset_stretch + rise * (critical_stretch - onset_stretch);
  }
  /// f_p, the largest force over c.
  [[nodiscard]] double peak_force() const {
    return onset_stretch + hardening * (peak() - onset_stretch);
  }

 private:
  [[nodiscard]] double force(double s) const;
  [[nodiscard]] double share_of_fall(double s) const;
};

}  // namespace peristat
