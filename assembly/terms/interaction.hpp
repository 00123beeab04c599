#pragma once

#include "src/measures/small_algebra.hpp"

namespace peristat {

/// The only place that knows measure and potential at once: derivatives of the weighted energy
/// w psi(m(x)) of an interaction with respect to its arms (relative vectors), by the chain rule.

/// Weighted potential w psi(m; M) and its derivatives with respect to the measure.
template <class Real>
struct InteractionEnergy {
  Real value;   ///< w M phi [J]
  Real first;   ///< w phi'
  Real second;  ///< w phi'' / M
};

/// @param weight quadrature weight, negative where the signed reference measure M is
template <class Real, class P, class MeasureAt>
[[nodiscard, gnu::always_inline]] inline InteractionEnergy<Real> interaction_energy(
    const Real& weight, const P& potential, const MeasureAt& measure) {
  const auto phi = potential(measure.relative_change);
  return {weight * phi.value / measure.inverse_reference, weight * phi.first,
          weight * phi.second * measure.inverse_reference};
}

/// psi' grad m
template <class Real, class MeasureAt>
[[nodiscard, gnu::always_inline]] inline auto energy_gradient(const InteractionEnergy<Real>& psi,
                                                              const MeasureAt& measure) {
  auto result = measure.gradient;
  for (auto& arm : result) arm = scaled<MeasureAt::dimension>(psi.first, arm);
  return result;
}

/// Block between arms P and Q of psi'' grad m (grad m)^T + psi' hess m
template <int P, int Q, class Real, class MeasureAt>
[[nodiscard]] inline auto energy_hessian(const InteractionEnergy<Real>& psi,
                                         const MeasureAt& measure) {
  constexpr int D = MeasureAt::dimension;
  constexpr bool on_diagonal = P == Q;  // symmetric: its lower half mirrors the upper
  Matrix<D, Real> block;
  const Vector<D, Real> row = scaled<D>(psi.second, measure.gradient[P]);
  for (int r = 0; r < D; ++r) {
    for (int c = on_diagonal ? r : 0; c < D; ++c) block[r][c] = row[r] * measure.gradient[Q][c];
  }
  measure.template add_hessian<P, Q>(psi.first, block);
  if constexpr (on_diagonal) {
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < r; ++c) block[r][c] = block[c][r];
    }
  }
  return block;
}

/// (psi'' grad m (grad m)^T + psi' hess m) v
template <class Real, class MeasureAt, class ArmVectors>
[[nodiscard]] inline ArmVectors energy_hessian_times(const InteractionEnergy<Real>& psi,
                                                     const MeasureAt& measure,
                                                     const ArmVectors& v) {
  constexpr int D = MeasureAt::dimension;
  Real along = dot<D>(measure.gradient[0], v[0]);
  for (int p = 1; p < MeasureAt::arms; ++p) along += dot<D>(measure.gradient[p], v[p]);
  along *= psi.second;
  ArmVectors result = measure.hessian_times(v);
  for (int p = 0; p < MeasureAt::arms; ++p) {
    result[p] = plus<D>(scaled<D>(along, measure.gradient[p]), scaled<D>(psi.first, result[p]));
  }
  return result;
}

}  // namespace peristat
