#include "src/materials/bond_constants.hpp"

#include <cmath>
#include <numbers>

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi;

/// Micromodulus per Young's modulus [1/m4].
double micromodulus_per_modulus(const BondSetting& setting) {
  const double horizon = setting.horizon;
  const double section = setting.cross_section;
  switch (setting.dimension) {
    case 1:
      return 2.0 / (section * horizon * horizon);
    case 2:
      return (setting.plane == PlaneState::stress ? 9.0 : 48.0 / 5.0) /
             (pi * std::pow(horizon, 3) * section);
    default:
      return 12.0 / (pi * std::pow(horizon, 4));
  }
}

}  // namespace

double micromodulus(double youngs_modulus, const BondSetting& setting) {
  return youngs_modulus * micromodulus_per_modulus(setting);
}

double youngs_modulus_of(double micromodulus, const BondSetting& setting) {
  return micromodulus / micromodulus_per_modulus(setting);
}

double poisson_ratio(const BondSetting& setting) {
  if (setting.dimension == 1) return 0.0;
  return setting.dimension == 2 && setting.plane == PlaneState::stress ? 1.0 / 3.0 : 0.25;
}

double confined_energy_per_modulus(const BondSetting& setting) {
  const double nu = poisson_ratio(setting);
  if (setting.dimension == 2 && setting.plane == PlaneState::stress) return 0.5 / (1.0 - nu * nu);
  return 0.5 * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
}

}  // namespace peristat
