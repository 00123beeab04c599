#pragma once

#include "src/measures/small_algebra.hpp"

namespace peristat {

/// Volume of the parallelepiped of a tetrahedron's three arms b = xi1, c = xi2, d = xi3, six times
/// the tetrahedron's own; B, C, D are the reference arms, beta, gamma, delta their relative
/// displacements.
///
///   value      v = b.(c x d)                                             [m3]
///   gradient   dv/db = c x d,  dv/dc = d x b,  dv/dd = b x c             [m2]
///   Hessian    d2v/dbdc = -[d]x,  d2v/dcdd = -[b]x,  d2v/dddb = -[c]x,
///              zero on the diagonal                                      [m]
///
/// ([CPD] eqs. 4 and 20; its eq. 75 prints -v/|v|^3 for v/|v|, and eq. 76 lacks permutation
/// tensors.) The sign is kept, in the reference too: an interaction with a negative reference
/// volume carries a negative weight (see Interactions). [CPD] takes |v|, for which an inverted
/// tetrahedron costs no energy; the signed volume is the same up to inversion and resists it. It is
/// smooth everywhere.
struct Volume {
  static constexpr int arms = 3;

  template <int D>
  static constexpr bool singular_at_zero = false;

  template <int D, class Real>
  struct At {
    static_assert(D == 3, "a volume needs three dimensions");
    static constexpr int arms = 3, dimension = 3;

    Real inverse_reference;  ///< 1/V, signed [1/m3]
    Real current;            ///< v, signed [m3]
    Real relative_change;    ///< v/V - 1
    Arms<3, 3, Real> gradient;
    Arms<3, 3, Real> arm;  ///< b, c, d

    template <int P, int Q>
    [[gnu::always_inline]] void add_hessian(const Real& factor, Matrix<3, Real>& block) const {
      if constexpr (P != Q) {
        constexpr bool cyclic = (P + 1) % 3 == Q;
        add_skew<Real>(cyclic ? -factor : factor, arm[3 - P - Q], block);
      }
    }

    [[nodiscard, gnu::always_inline]] Arms<3, 3, Real> hessian_times(
        const Arms<3, 3, Real>& v) const {
      // Change of each gradient with the two arms that it depends on.
      return {plus<3>(cross(v[1], arm[2]), cross(arm[1], v[2])),
              plus<3>(cross(v[2], arm[0]), cross(arm[2], v[0])),
              plus<3>(cross(v[0], arm[1]), cross(arm[0], v[1]))};
    }
  };

  /// The measure from 1/V, the reference arms and the relative displacements [m], free of
  /// cancellation: v - V = beta.(c x d) + B.(gamma x d) + B.(C x delta).
  template <int D, class Real>
  [[nodiscard, gnu::always_inline]] static At<D, Real> at(
      const Real& inverse_reference, const Arms<3, D, Real>& reference,
      const Arms<3, D, Real>& relative_displacement) {
    At<D, Real> result;
    result.inverse_reference = inverse_reference;
    for (int p = 0; p < 3; ++p) {
      result.arm[p] = plus<3>(reference[p], relative_displacement[p]);
    }
    const auto& [b, c, d] = result.arm;
    const auto& [beta, gamma, delta] = relative_displacement;
    result.gradient = {cross(c, d), cross(d, b), cross(b, c)};
    result.current = dot<3>(result.gradient[2], d);
    // beta.(c x d) = (beta x c).d: the vectors of the first two arms alone come first, so that they
    // are computed once for all tetrahedra that share these.
    const Vector<3, Real> of_current = plus<3>(cross(beta, c), cross(reference[0], gamma));
    const Vector<3, Real> of_change = cross(reference[0], reference[1]);
    result.relative_change = (dot<3>(of_current, d) + dot<3>(of_change, delta)) * inverse_reference;
    return result;
  }

  /// Its value alone.
  template <int D, class Real>
  [[nodiscard, gnu::always_inline]] static Real value(const Arms<3, D, Real>& arm) {
    return dot<3>(cross(arm[0], arm[1]), arm[2]);
  }
};

}  // namespace peristat
