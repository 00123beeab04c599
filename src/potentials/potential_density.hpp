#pragma once

namespace peristat {

/// Density phi(e) of a potential and its derivatives with respect to the relative change e = m/M -
/// 1 of a measure m with reference value M. The potential itself is psi(m; M) = M phi(m/M - 1), so
/// that dpsi/dm = phi'(e) and d2psi/dm2 = phi''(e) / M.
template <class Real>
struct PotentialDensity {
  Real value;   ///< phi
  Real first;   ///< phi'
  Real second;  ///< phi''
};

}  // namespace peristat
