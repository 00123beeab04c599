#pragma once

#include <cmath>

#include "src/core/lanes.hpp"

namespace peristat {

/// Weight of a triangle or tetrahedron by how flat it is. The relative change m/M - 1 of a measure
/// has no meaning for points on a line (in a plane), and the energy M (m/M - 1)^2 of nearly flat
/// ones grows without bound under anything but a homogeneous deformation. With t = |M| / M0, M0 the
/// cell measure of the interaction's points,
///
///   g(t) = 0 for t <= 1/4,   s^2 (3 - 2 s) with s = 2 t - 1/2 between,   1 for t >= 3/4
///
/// multiplies the weight, and replaces 1 in the counts #N2 and #N3: all of these are then once
/// continuously differentiable functions of the points' positions, and |M| is at least M0/4 where
/// there is any energy. On a cubic lattice t is 0 or at least 1, whatever the round-off: nothing
/// changes there.
inline constexpr double flat_measure = 0.25, full_measure = 0.75;

/// g(t) [-]
template <class Real>
[[nodiscard]] inline Real flatness_factor(const Real& relative_measure) {
  using std::max, std::min;
  const Real ramp = (relative_measure - flat_measure) / (full_measure - flat_measure);
  const Real s = min(max(ramp, Real(0.0)), Real(1.0));
  return s * s * (3.0 - 2.0 * s);
}

/// Measure of a point's cell: of the parallelogram or parallelepiped that `arms` sides of a square
/// or cube of its volume span, (V/h)^(arms/dimension); spacing^arms on a lattice.
[[nodiscard]] inline double cell_measure(double volume, double cross_section, int arms,
                                         int dimension) {
  return std::pow(volume / cross_section, double(arms) / dimension);
}

}  // namespace peristat
