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

  /// True if a value of zero has no gradient.
  template <int D>
  static constexpr bool singular_at_zero = true;

  template <class Real>
  struct Scalars {
    Real inverse_reference;  ///< 1/L [1/m]
    Real current;            ///< l [m]
    Real relative_change;    ///< l/L - 1, the stretch s
    Real inverse;            ///< 1/l [1/m]
  };

  template <int D, class Real>
  struct At : Scalars<Real> {
    static constexpr int arms = 1, dimension = D;

    Arms<1, D, Real> gradient;  ///< n

    /// block += factor times the Hessian's block between arms P and Q; on the diagonal its upper
    /// half.
    template <int P, int Q>
    void add_hessian(const Real& factor, Matrix<D, Real>& block) const {
      const Real scale = factor * this->inverse;
      for (int r = 0; r < D; ++r) block[r][r] += scale;
      add_outer_square<D, Real>(-scale, gradient[0], block);
    }

    /// Hessian times relative vectors.
    [[nodiscard]] Arms<1, D, Real> hessian_times(const Arms<1, D, Real>& v) const {
      const Vector<D, Real>& n = gradient[0];
      const Real along = dot<D>(n, v[0]);
      Arms<1, D, Real> result;
      for (int c = 0; c < D; ++c) result[0][c] = (v[0][c] - along * n[c]) * this->inverse;
      return result;
    }
  };

  /// The measure from 1/L, the reference vector xi0 and the relative displacement eta [m]. The
  /// stretch is free of cancellation,
  ///   s = eta.(2 xi0 + eta) / (L (L + l)) = eta.(2 xi0 + eta) / L^2 / (1 + l/L):
  /// the difference of two nearly equal lengths would stall a relative residual near 1e-8.
  template <int D, class Real>
  [[nodiscard]] static At<D, Real> at(const Real& inverse_reference,
                                      const Arms<1, D, Real>& reference,
                                      const Arms<1, D, Real>& relative_displacement) {
    const Vector<D, Real> current_arm = plus<D>(reference[0], relative_displacement[0]);
    const Scalars<Real> scalars =
        from_squares(inverse_reference, dot<D>(current_arm, current_arm),
                     dot<D>(relative_displacement[0], plus<D>(reference[0], current_arm)));
    return {scalars, {scaled<D>(scalars.inverse, current_arm)}};
  }

  /// The same from l^2 and eta.(2 xi0 + eta) = l^2 - L^2, without the gradient: one division, by
  /// l (1 + l/L), for 1/l and the stretch.
  template <class Real>
  [[nodiscard, gnu::always_inline]] static Scalars<Real> from_squares(const Real& inverse_reference,
                                                                      const Real& squared,
                                                                      const Real& change) {
    const Real current = square_root(squared);
    const Real larger = 1.0 + current * inverse_reference;
    const Real inverse_of_both = 1.0 / (current * larger);
    return {inverse_reference, current,
            change * (inverse_reference * inverse_reference) * (inverse_of_both * current),
            inverse_of_both * larger};
  }

  /// The measure from the current vector xi alone. Its stretch l/L - 1 carries an absolute error of
  /// one round-off: too much for forces, as good as any other entry for a tangent.
  template <int D, class Real>
  [[nodiscard]] static At<D, Real> from_current(const Real& inverse_reference,
                                                const Arms<1, D, Real>& current) {
    const Scalars<Real> scalars = from_square(inverse_reference, dot<D>(current[0], current[0]));
    return {scalars, {scaled<D>(scalars.inverse, current[0])}};
  }

  /// The same from l^2, without the gradient.
  template <class Real>
  [[nodiscard, gnu::always_inline]] static Scalars<Real> from_square(const Real& inverse_reference,
                                                                     const Real& squared) {
    const Real current = square_root(squared);
    return {inverse_reference, current, current * inverse_reference - 1.0, 1.0 / current};
  }

  template <int D, class Real>
  [[nodiscard]] static Real value(const Arms<1, D, Real>& arm) {
    return square_root(dot<D>(arm[0], arm[0]));
  }
};

}  // namespace peristat
