#pragma once

namespace peristat {

/// Value and derivatives of a potential with respect to its measure m.
template <class Real>
struct PotentialValue {
  Real value;   ///< psi
  Real first;   ///< dpsi/dm
  Real second;  ///< d2psi/dm2
};

/// Harmonic potential, quadratic in the relative change e = m/M - 1 of a measure:
///
///   psi = 1/2 C M e^2,   dpsi/dm = C e,   d2psi/dm2 = C / M       (eqs. 23-25 of [CPD])
///
/// For bonds C is the micromodulus c [N/m6], and dpsi/dm = c s the pairwise force density of eq. 3
/// of [ADAPT] with the stretch s.
struct Harmonic {
  double modulus = 0.0;  ///< C [N/m6] for length

  /// @param reference M, @param relative_change m/M - 1
  template <class Real>
  [[nodiscard]] PotentialValue<Real> operator()(const Real& reference,
                                                const Real& relative_change) const {
    const Real first = modulus * relative_change;
    return {0.5 * first * relative_change * reference, first, modulus / reference};
  }
};

}  // namespace peristat
