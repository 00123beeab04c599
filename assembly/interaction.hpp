#pragma once

#include "src/measures/small_algebra.hpp"

namespace peristat {

/// The only place that knows measure and potential at once: derivatives of the weighted energy
/// w psi(m(x)) of an interaction with respect to its relative vectors, by the chain rule.
/// `Size` is the number of components of all arms together.

/// Weighted potential w psi(m; M) and its derivatives with respect to the measure.
template <class Real>
struct InteractionEnergy {
  Real value;   ///< w M phi [J]
  Real first;   ///< w phi'
  Real second;  ///< w phi'' / M
};

template <class Real, class P, class MeasureAt>
[[nodiscard]] inline InteractionEnergy<Real> interaction_energy(const Real& weight,
                                                                const P& potential,
                                                                const MeasureAt& measure) {
  const auto phi = potential(measure.relative_change);
  return {weight * phi.value / measure.inverse_reference, weight * phi.first,
          weight * phi.second * measure.inverse_reference};
}

/// psi' grad m
template <int Size, class Real, class MeasureAt>
[[nodiscard]] inline Vector<Size, Real> energy_gradient(const InteractionEnergy<Real>& psi,
                                                        const MeasureAt& measure) {
  return scaled<Size>(psi.first, measure.gradient());
}

/// psi'' grad m (grad m)^T + psi' hess m
template <int Size, class Real, class MeasureAt>
[[nodiscard]] inline Matrix<Size, Real> energy_hessian(const InteractionEnergy<Real>& psi,
                                                       const MeasureAt& measure) {
  const Vector<Size, Real>& gradient = measure.gradient();
  Matrix<Size, Real> result = measure.hessian();
  for (int r = 0; r < Size; ++r) {
    for (int c = r; c < Size; ++c) {
      result[r][c] = result[c][r] =
          psi.second * gradient[r] * gradient[c] + psi.first * result[r][c];
    }
  }
  return result;
}

/// (psi'' grad m (grad m)^T + psi' hess m) v
template <int Size, class Real, class MeasureAt>
[[nodiscard]] inline Vector<Size, Real> energy_hessian_times(const InteractionEnergy<Real>& psi,
                                                             const MeasureAt& measure,
                                                             const Vector<Size, Real>& v) {
  const Vector<Size, Real>& gradient = measure.gradient();
  const Real along = psi.second * dot<Size>(gradient, v);
  return plus<Size>(scaled<Size>(along, gradient),
                    scaled<Size>(psi.first, measure.hessian_times(v)));
}

}  // namespace peristat
