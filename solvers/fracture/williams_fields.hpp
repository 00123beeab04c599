#pragma once

#include "src/core/types.hpp"

namespace peristat {

/// Constants of isotropic elasticity in the fields at a crack's tip.
struct TipElasticity {
  double shear_modulus = 0.0;  ///< mu [Pa]
  double kolosov = 0.0;        ///< (3 - nu)/(1 + nu) in plane stress, 3 - 4 nu in plane strain
  double plane_modulus = 0.0;  ///< E' [Pa]: E in plane stress, E/(1 - nu^2) in plane strain
  double poisson_ratio = 0.0;  ///< nu

  [[nodiscard]] static TipElasticity plane_stress(double youngs_modulus, double poisson_ratio);
  [[nodiscard]] static TipElasticity plane_strain(double youngs_modulus, double poisson_ratio);
};

/// Displacement [m] of Williams' singular field of a mode (0, 1, 2 for I, II, III) with the stress
/// intensity factor 1 Pa m^1/2, in the frame of the tip:
///
///   I    sqrt(r/2 pi)/(2 mu) { cos(t/2) (k - 1 + 2 sin^2(t/2)),
///                              sin(t/2) (k + 1 - 2 cos^2(t/2)), 0}
///   II   sqrt(r/2 pi)/(2 mu) { sin(t/2) (k + 1 + 2 cos^2(t/2)),
///                             -cos(t/2) (k - 1 - 2 sin^2(t/2)), 0}
///   III  sqrt(r/2 pi) 2/mu   {0, 0, sin(t/2)}
[[nodiscard]] Coordinates williams_displacement(int mode, const Coordinates& at,
                                                const TipElasticity& elasticity);

/// Displacement [m] of a force of 1 N/m per length of the front on the tip along e1, without the
/// stress across the front: the field whose interaction with another one gives the T-stress of that
/// (Kfouri 1986), with E' and nu' = (3 - k)/(1 + k):
///
///   u1 = -(ln (r/R) + (1 + nu') sin^2 t / 2)/(pi E'),
///   u2 = -((1 - nu') t - (1 + nu') sin t cos t)/(2 pi E')
///
/// R, a length of the body, only shifts the field as a whole, and makes it independent of units.
/// @param still R [m]
[[nodiscard]] Coordinates tip_force_displacement(const Coordinates& at,
                                                 const TipElasticity& elasticity, double still);

}  // namespace peristat
