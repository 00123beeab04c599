#pragma once

#include "src/measures/length.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {

/// Length of a bond linearised at rest: with xi0 the reference vector, L = |xi0| and eta the
/// relative displacement,
///
///   value      L + xi0 . eta / L   [m]
///   gradient   xi0 / L             [-]
///   Hessian    0
///
/// It never vanishes and knows no direction but that of the reference.
struct LinearLength {
  static constexpr int arms = 1;

  template <int D>
  static constexpr bool singular_at_zero = false;

  template <int D, class Real>
  using At = Length::At<D, Real>;

  /// @param reference also stands for the current vector, whose inverse length counts as zero: so
  ///        the Hessian is
  template <int D, class Real>
  [[nodiscard]] static At<D, Real> at(const Real& inverse_reference,
                                      const Arms<1, D, Real>& reference,
                                      const Arms<1, D, Real>& relative_displacement) {
    At<D, Real> result = from_reference<D, Real>(inverse_reference, reference);
    result.relative_change =
        dot<D>(result.gradient[0], relative_displacement[0]) * inverse_reference;
    return result;
  }

  /// The measure at rest.
  template <int D, class Real>
  [[nodiscard]] static At<D, Real> from_reference(const Real& inverse_reference,
                                                  const Arms<1, D, Real>& reference) {
    At<D, Real> result;
    result.inverse_reference = inverse_reference;
    result.current = 1.0 / inverse_reference;
    result.relative_change = 0.0;
    result.inverse = 0.0;
    result.gradient[0] = scaled<D>(inverse_reference, reference[0]);
    return result;
  }
};

}  // namespace peristat
