#include "solvers/fracture/williams_fields.hpp"

#include <cmath>
#include <numbers>

namespace peristat {

TipElasticity TipElasticity::plane_stress(double youngs_modulus, double poisson_ratio) {
  const double nu = poisson_ratio;
  return {youngs_modulus / (2.0 * (1.0 + nu)), (3.0 - nu) / (1.0 + nu), youngs_modulus, nu};
}

TipElasticity TipElasticity::plane_strain(double youngs_modulus, double poisson_ratio) {
  const double nu = poisson_ratio;
  return {youngs_modulus / (2.0 * (1.0 + nu)), 3.0 - 4.0 * nu, youngs_modulus / (1.0 - nu * nu),
          nu};
}

Coordinates williams_displacement(int mode, const Coordinates& at,
                                  const TipElasticity& elasticity) {
  const double r = std::hypot(at[0], at[1]), half = 0.5 * std::atan2(at[1], at[0]);
  const double s = std::sin(half), c = std::cos(half), k = elasticity.kolosov;
  const double size = std::sqrt(r / (2.0 * std::numbers::pi)) / (2.0 * elasticity.shear_modulus);
  if (mode == 0) {
    return {size * c * (k - 1.0 + 2.0 * s * s), size * s * (k + 1.0 - 2.0 * c * c), 0.0};
  }
  if (mode == 1) {
    return {size * s * (k + 1.0 + 2.0 * c * c), -size * c * (k - 1.0 - 2.0 * s * s), 0.0};
  }
  return {0.0, 0.0, 4.0 * size * s};
}

Coordinates tip_force_displacement(const Coordinates& at, const TipElasticity& elasticity,
                                   double still) {
  const double r = std::hypot(at[0], at[1]);
  if (r == 0.0) return {};
  const double angle = std::atan2(at[1], at[0]), s = at[1] / r, c = at[0] / r;
  const double nu = (3.0 - elasticity.kolosov) / (1.0 + elasticity.kolosov);
  const double size = -1.0 / (std::numbers::pi * elasticity.plane_modulus);
  return {size * (std::log(r / still) + 0.5 * (1.0 + nu) * s * s),
          0.5 * size * ((1.0 - nu) * angle - (1.0 + nu) * s * c), 0.0};
}

}  // namespace peristat
