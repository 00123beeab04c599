#pragma once

#include <cmath>

namespace peristat {

/// Energy of a contact over its relative depth x = (d - r) / (a d), 0 where the gap r reaches the
/// distance d of contact, 1 at the largest depth a d:
///
///   b' = s / (1 - s),  s = 0 (x <= 0),  x^2 / (2 x0) (x <= x0),  x - x0 / 2 beyond,
///
/// twice continuously differentiable, nearly linear with the slope 1, and a barrier near x = 1. A
/// contact of the stiffness k has the energy k (a d)^2 b and the force k a d b'. Beyond x = 1 the
/// force goes on along its tangent, so that a state there has finite values; it is no state of the
/// body.
///
/// Source: the penalty of small depths joined to a barrier as of incremental potential contact [Li
/// et al. 2020], whose own barrier has no stiffness at small depths.
struct ContactLaw {
  double bend = 4e-4;  ///< x0, the depth over which the stiffness sets in, 0 < x0 < 1

  struct Value {
    double value = 0.0, first = 0.0, second = 0.0;  ///< b, b', b''
  };

  [[nodiscard]] Value operator()(double x) const {
    if (!(x > 0.0)) return {};
    if (x > 1.0) {
      const Value end = (*this)(1.0);
      const double beyond = x - 1.0;
      return {end.value + beyond * (end.first + 0.5 * beyond * end.second),
              end.first + beyond * end.second, end.second};
    }
    const bool sets_in = x <= bend;
    const double s = sets_in ? 0.5 * x * x / bend : x - 0.5 * bend;
    const double slope = sets_in ? x / bend : 1.0, left = 1.0 - s;
    return {sets_in ? in_onset(x) : in_onset(bend) + of_line(s) - of_line(0.5 * bend), s / left,
            slope / (left * left)};
  }

 private:
  /// Integral of b' from 0 in the onset: q artanh(x / q) - x with q^2 = 2 x0.
  [[nodiscard]] double in_onset(double x) const {
    const double q = std::sqrt(2.0 * bend), t = x / q;
    if (t > 0.01) return q * std::atanh(t) - x;
    const double t2 = t * t;
    return q * t * t2 * (1.0 / 3.0 + t2 * (1.0 / 5.0 + t2 / 7.0));
  }
  /// -s - ln(1 - s), without cancellation.
  [[nodiscard]] static double of_line(double s) {
    if (s > 0.01) return -s - std::log1p(-s);
    return s * s * (0.5 + s * (1.0 / 3.0 + s * (0.25 + s * (0.2 + s / 6.0))));
  }
};

/// The law as a linear spring that also pulls, for contacts that a predictor counts as closed.
[[nodiscard]] inline ContactLaw::Value closed_contact(double x) { return {0.5 * x * x, x, 1.0}; }

}  // namespace peristat
