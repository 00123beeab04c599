#include "src/materials/bond_constants.hpp"

#include <cmath>
#include <numbers>

namespace peristat {
namespace {

/// Mean of n_x^4 over all directions n in 1D, 2D and 3D.
constexpr double mean_of_fourth_power[] = {1.0, 3.0 / 8.0, 1.0 / 5.0};

double critical_stretch_of_moment(double fracture_energy, double micromodulus, int dimension,
                                  double second_moment) {
  const double mean = mean_of_magnitude(dimension);
  return std::sqrt(4.0 * fracture_energy / (micromodulus * mean * second_moment));
}

}  // namespace

double mean_of_magnitude(int dimension) {
  constexpr double means[] = {1.0, 2.0 / std::numbers::pi, 1.0 / 2.0};
  return means[dimension - 1];
}

double micromodulus(double youngs_modulus, const BondSetting& setting, double first_moment) {
  const double mean = mean_of_fourth_power[setting.dimension - 1];
  return 4.0 * confined_energy_per_modulus(setting) * youngs_modulus / (mean * first_moment);
}

double micromodulus(double youngs_modulus, const BondSetting& setting) {
  return micromodulus(youngs_modulus, setting, setting.moment(1));
}

double lattice_micromodulus(double youngs_modulus, const BondSetting& setting,
                            const Spacing& spacing) {
  return micromodulus(youngs_modulus, setting, setting.lattice_moment(1, spacing));
}

double youngs_modulus_of(double micromodulus, const BondSetting& setting) {
  return micromodulus / peristat::micromodulus(1.0, setting, setting.moment(1));
}

double critical_stretch(double fracture_energy, double micromodulus, const Kernel& kernel) {
  return critical_stretch_of_moment(fracture_energy, micromodulus, kernel.dimension,
                                    kernel.moment(2));
}

double lattice_critical_stretch(double fracture_energy, double micromodulus, const Kernel& kernel,
                                const Spacing& spacing) {
  return critical_stretch_of_moment(fracture_energy, micromodulus, kernel.dimension,
                                    kernel.lattice_moment(2, spacing));
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
