#pragma once

#include "src/measures/small_algebra.hpp"

namespace peristat {

/// Length l = |xi| of a bond: xi = xi0 + eta is the current vector from its first to its second
/// point, xi0 the reference vector, eta the relative displacement, L = |xi0|.
///
///   value      l                        [m]
///   gradient   dl/dxi = n = xi / l      [-]
///   Hessian    d2l/dxi2 = (I - n n^T)/l [1/m]                  ([CPD] sec. 3.1)
///
/// Derivatives are with respect to the second point; the first point's are minus these. A length of
/// zero has no gradient: the results are then not finite, and assembly reports the state as
/// degenerate.
struct Length {
  /// Relative vectors (arms) that the measure depends on.
  static constexpr int arms = 1;

  template <int D, class Real>
  struct At {
    Real inverse_reference;     ///< 1/L [1/m]
    Real current;               ///< l [m]
    Real relative_change;       ///< l/L - 1, the stretch s
    Vector<D, Real> direction;  ///< n
    Real inverse;               ///< 1/l [1/m]

    [[nodiscard]] const Vector<D, Real>& gradient() const { return direction; }

    [[nodiscard]] Matrix<D, Real> hessian() const {
      Matrix<D, Real> result;
      for (int r = 0; r < D; ++r) {
        for (int c = r; c < D; ++c) {
          const Real identity = r == c ? 1.0 : 0.0;
          result[r][c] = result[c][r] = (identity - direction[r] * direction[c]) * inverse;
        }
      }
      return result;
    }

    /// Hessian times a relative vector.
    [[nodiscard]] Vector<D, Real> hessian_times(const Vector<D, Real>& v) const {
      const Real along = dot<D>(direction, v);
      Vector<D, Real> result;
      for (int c = 0; c < D; ++c) result[c] = (v[c] - along * direction[c]) * inverse;
      return result;
    }
  };

  /// The measure from 1/L, the reference vector xi0 and the relative displacement eta [m]. The
  /// stretch is free of cancellation,
  ///   s = eta.(2 xi0 + eta) / (L (L + l)) = eta.(2 xi0 + eta) / L^2 / (1 + l/L):
  /// the difference of two nearly equal lengths would stall a relative residual near 1e-8.
  template <int D, class Real>
  [[nodiscard]] static At<D, Real> at(const Real& inverse_reference, const Vector<D, Real>& arm,
                                      const Vector<D, Real>& relative_displacement) {
    const Vector<D, Real> current_arm = plus<D>(arm, relative_displacement);
    At<D, Real> result = from_current<D>(inverse_reference, current_arm);
    result.relative_change = dot<D>(relative_displacement, plus<D>(arm, current_arm)) *
                             inverse_reference * inverse_reference /
                             (1.0 + result.current * inverse_reference);
    return result;
  }

  /// The measure from the current vector xi alone. Its stretch l/L - 1 carries an absolute error of
  /// one round-off: too much for forces, as good as any other entry for a tangent.
  template <int D, class Real>
  [[nodiscard]] static At<D, Real> from_current(const Real& inverse_reference,
                                                const Vector<D, Real>& current_arm) {
    At<D, Real> result;
    result.inverse_reference = inverse_reference;
    result.current = square_root(dot<D>(current_arm, current_arm));
    result.relative_change = result.current * inverse_reference - 1.0;
    result.inverse = 1.0 / result.current;
    result.direction = scaled<D>(result.inverse, current_arm);
    return result;
  }
};

}  // namespace peristat
