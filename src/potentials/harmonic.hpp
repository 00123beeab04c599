#pragma once

#include "src/potentials/potential_density.hpp"

namespace peristat {

/// Harmonic potential, quadratic in the relative change:
///
///   phi = C e^2 / 2,  i.e.  psi = C M e^2 / 2,  dpsi/dm = C e,  d2psi/dm2 = C / M
///                                                                    (eqs. 23-25 of [CPD])
///
/// For bonds C is the micromodulus c [N/m6], and dpsi/dm = c s the pairwise force density of eq. 3
/// of [ADAPT] with the stretch s.
struct Harmonic {
  static constexpr const char* name = "harmonic";
  double modulus = 0.0;  ///< C [N/m6] for length

  /// @param e relative change of the measure
  template <class Real>
  [[nodiscard, gnu::always_inline]] PotentialDensity<Real> operator()(const Real& e) const {
    const Real first = modulus * e;
    return {0.5 * first * e, first, Real(modulus)};
  }
};

}  // namespace peristat
