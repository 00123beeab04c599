#pragma once

#include "src/measures/small_algebra.hpp"

namespace peristat {

/// Area of the parallelogram of a triangle's two arms b = xi1 and c = xi2, twice the triangle's
/// own; B, C are the reference arms, beta and gamma their relative displacements.
///
/// In 3D ([CPD] eqs. 3 and 20), with n = (b x c)/a:
///
///   value      a = |b x c|                                               [m2]
///   gradient   da/db = c x n,  da/dc = n x b                             [m]
///   Hessian    d2a/db2 = |c|^2 n n^T/a,  d2a/dc2 = |b|^2 n n^T/a,
///              d2a/dbdc = -(b.c) n n^T/a - [n]x                          [-]
///
/// (eq. 71 of [CPD] in a shorter form: its terms within the triangle's plane cancel.) An area
/// of zero has no gradient: the results are then not finite, and assembly reports the state as
/// degenerate.
///
/// In 2D the area is signed, a = b1 c2 - b2 c1, of either sign in the reference too: an interaction
/// with a negative one carries a negative weight (see Interactions). It is smooth everywhere, and a
/// triangle that is turned over has a relative change below -1 instead of none.
struct Area {
  static constexpr int arms = 2;

  template <int D>
  static constexpr bool singular_at_zero = D == 3;

  template <int D, class Real>
  struct At;

  /// The measure from 1/A, the reference arms and the relative displacements [m], free of
  /// cancellation: with the area vectors a = b x c and A = B x C,
  ///   a - A = beta x c + B x gamma =: d,   |a|/|A| - 1 = d.(a + A) / |A|^2 / (1 + |a|/|A|).
  template <int D, class Real>
  [[nodiscard, gnu::always_inline]] static At<D, Real> at(
      const Real& inverse_reference, const Arms<2, D, Real>& reference,
      const Arms<2, D, Real>& relative_displacement);

  /// Its value alone: signed in 2D.
  template <int D, class Real>
  [[nodiscard, gnu::always_inline]] static Real value(const Arms<2, D, Real>& arm);
};

template <class Real>
struct Area::At<2, Real> {
  static constexpr int arms = 2, dimension = 2;

  Real inverse_reference;     ///< 1/A, signed [1/m2]
  Real current;               ///< a, signed [m2]
  Real relative_change;       ///< a/A - 1
  Arms<2, 2, Real> gradient;  ///< da/db = (c2, -c1), da/dc = (-b2, b1)

  template <int P, int Q>
  [[gnu::always_inline]] void add_hessian(const Real& factor, Matrix<2, Real>& block) const {
    if constexpr (P < Q) {
      block[0][1] += factor;
      block[1][0] -= factor;
    } else if constexpr (P > Q) {
      block[0][1] -= factor;
      block[1][0] += factor;
    }
  }

  [[nodiscard, gnu::always_inline]] Arms<2, 2, Real> hessian_times(
      const Arms<2, 2, Real>& v) const {
    return {{{v[1][1], -v[1][0]}, {-v[0][1], v[0][0]}}};
  }
};

template <class Real>
struct Area::At<3, Real> {
  static constexpr int arms = 2, dimension = 3;

  Real inverse_reference;  ///< 1/A [1/m2]
  Real current;            ///< a [m2]
  Real relative_change;    ///< a/A - 1
  Arms<2, 3, Real> gradient;
  Arms<2, 3, Real> arm;    ///< b, c
  Vector<3, Real> normal;  ///< n
  Real inverse;            ///< 1/a [1/m2]

  template <int P, int Q>
  [[gnu::always_inline]] void add_hessian(const Real& factor, Matrix<3, Real>& block) const {
    // |other arm|^2 on the diagonal, -b.c off it.
    if constexpr (P == Q) {
      add_outer_square<3, Real>(factor * inverse * dot<3>(arm[1 - P], arm[1 - P]), normal, block);
    } else {
      add_outer<3>(-factor * inverse * dot<3>(arm[0], arm[1]), normal, normal, block);
      add_skew<Real>(P < Q ? -factor : factor, normal, block);
    }
  }

  [[nodiscard, gnu::always_inline]] Arms<2, 3, Real> hessian_times(
      const Arms<2, 3, Real>& v) const {
    const Real mixed = dot<3>(arm[0], arm[1]);
    const Real out0 = dot<3>(normal, v[0]) * inverse, out1 = dot<3>(normal, v[1]) * inverse;
    const Real along0 = dot<3>(arm[1], arm[1]) * out0 - mixed * out1;
    const Real along1 = dot<3>(arm[0], arm[0]) * out1 - mixed * out0;
    const Vector<3, Real> turned0 = cross(v[1], normal), turned1 = cross(normal, v[0]);
    return {plus<3>(scaled<3>(along0, normal), turned0),
            plus<3>(scaled<3>(along1, normal), turned1)};
  }
};

template <int D, class Real>
inline Real Area::value(const Arms<2, D, Real>& arm) {
  if constexpr (D == 2) {
    return arm[0][0] * arm[1][1] - arm[0][1] * arm[1][0];
  } else {
    const Vector<3, Real> vector = cross(arm[0], arm[1]);
    return square_root(dot<3>(vector, vector));
  }
}

template <int D, class Real>
inline Area::At<D, Real> Area::at(const Real& inverse_reference, const Arms<2, D, Real>& reference,
                                  const Arms<2, D, Real>& relative_displacement) {
  const Vector<D, Real> b = plus<D>(reference[0], relative_displacement[0]);
  const Vector<D, Real> c = plus<D>(reference[1], relative_displacement[1]);
  At<D, Real> result;
  result.inverse_reference = inverse_reference;
  if constexpr (D == 2) {
    const auto area = [](const Vector<2, Real>& first, const Vector<2, Real>& second) {
      return value<2, Real>({first, second});
    };
    result.current = area(b, c);
    result.relative_change =
        (area(relative_displacement[0], c) + area(reference[0], relative_displacement[1])) *
        inverse_reference;
    result.gradient[0] = {c[1], -c[0]};
    result.gradient[1] = {-b[1], b[0]};
  } else {
    const Vector<3, Real> vector = cross(b, c);
    const Vector<3, Real> change =
        plus<3>(cross(relative_displacement[0], c), cross(reference[0], relative_displacement[1]));
    const Vector<3, Real> sum = minus<3>(plus<3>(vector, vector), change);  // a + A
    result.current = square_root(dot<3>(vector, vector));
    result.relative_change = dot<3>(change, sum) * inverse_reference * inverse_reference /
                             (1.0 + result.current * inverse_reference);
    result.inverse = 1.0 / result.current;
    result.normal = scaled<3>(result.inverse, vector);
    result.arm = {b, c};
    result.gradient[0] = cross(c, result.normal);
    result.gradient[1] = cross(result.normal, b);
  }
  return result;
}

}  // namespace peristat
