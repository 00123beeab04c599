#include "src/materials/bond_constants.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double youngs_modulus = 2.5;

/// Strain components xx, yy, zz, xy, xz, yz.
using Strain = std::array<double, 6>;

struct Direction {
  std::array<double, 3> n;
  double angle;  // solid angle that it stands for
};

/// Midpoint rules on the sphere: around the circle they are exact for the trigonometric polynomials
/// that occur, over z their error is of order 1e-7 with 2000 intervals.
std::vector<Direction> directions(int dimension) {
  if (dimension == 1) return {{{1, 0, 0}, 1.0}, {{-1, 0, 0}, 1.0}};
  std::vector<Direction> result;
  constexpr int around = 16, over = 2000;
  const int levels = dimension == 2 ? 1 : over;
  for (int k = 0; k < levels; ++k) {
    const double z = dimension == 2 ? 0.0 : -1.0 + (k + 0.5) * 2.0 / over;
    const double radius = std::sqrt(1.0 - z * z), height = dimension == 2 ? 1.0 : 2.0 / over;
    for (int m = 0; m < around; ++m) {
      const double phi = 2.0 * pi * m / around;
      result.push_back(
          {{radius * std::cos(phi), radius * std::sin(phi), z}, height * 2.0 * pi / around});
    }
  }
  return result;
}

/// Energy density of the peridynamic continuum under a uniform small strain: half of every bond's
/// c s^2 |xi| / 2 over the ball of the horizon, s = n.strain n.
double peridynamic_energy(const BondSetting& setting, double modulus, const Strain& strain) {
  constexpr int shells = 2000;
  double radial = 0.0;  // integral of |xi| over the radius
  for (int k = 0; k < shells; ++k) {
    const double r = (k + 0.5) * setting.horizon / shells;
    radial += r * std::pow(r, setting.dimension - 1) * setting.horizon / shells;
  }
  double angular = 0.0;  // of s^2 over the directions
  for (const auto& [n, angle] : directions(setting.dimension)) {
    const double stretch =
        strain[0] * n[0] * n[0] + strain[1] * n[1] * n[1] + strain[2] * n[2] * n[2] +
        2.0 * (strain[3] * n[0] * n[1] + strain[4] * n[0] * n[2] + strain[5] * n[1] * n[2]);
    angular += angle * stretch * stretch;
  }
  const double section = setting.dimension == 3 ? 1.0 : setting.cross_section;
  return 0.25 * modulus * radial * angular * section;
}

/// Hooke's law, with Poisson's ratio 1/3 in plane stress and 1/4 in plane strain and 3D.
double classical_energy(const BondSetting& setting, const Strain& e) {
  if (setting.dimension == 1) return 0.5 * youngs_modulus * e[0] * e[0];
  const bool plane_stress = setting.dimension == 2 && setting.plane == PlaneState::stress;
  const double nu = plane_stress ? 1.0 / 3.0 : 0.25;
  const double shear = youngs_modulus / (2.0 * (1.0 + nu));
  const double lambda = plane_stress ? youngs_modulus * nu / (1.0 - nu * nu)
                                     : youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const double trace = e[0] + e[1] + e[2];
  const double squares =
      e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2.0 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
  return 0.5 * lambda * trace * trace + shear * squares;
}

const BondSetting settings[] = {{1, PlaneState::stress, 0.3, 0.02},
                                {2, PlaneState::stress, 0.3, 0.02},
                                {2, PlaneState::strain, 0.3, 0.02},
                                {3, PlaneState::stress, 0.3, 1.0}};

/// Strains of a dimension: stretch along each axis, shear, and everything at once.
std::vector<Strain> strains(int dimension) {
  if (dimension == 1) return {{0.7, 0, 0, 0, 0, 0}};
  if (dimension == 2) {
    return {{1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}, {0, 0, 0, 1, 0, 0}, {0.7, -0.4, 0, 0.2, 0, 0}};
  }
  return {
      {1, 0, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}, {0, 0, 0, 0, 1, 0}, {0.7, -0.4, 0.1, 0.2, 0.3, -0.6}};
}

// The midpoint rules leave some 1e-7.
constexpr double quadrature_error = 1e-6;

TEST(BondConstants, GiveTheClassicalEnergyOfEveryUniformStrain) {
  for (const BondSetting& setting : settings) {
    const double modulus = micromodulus(youngs_modulus, setting);
    for (const Strain& strain : strains(setting.dimension)) {
      const double classical = classical_energy(setting, strain);
      ASSERT_GT(classical, 0.1);
      EXPECT_NEAR(peridynamic_energy(setting, modulus, strain) / classical, 1.0, quadrature_error)
          << "dimension " << setting.dimension;
    }
  }
}

TEST(BondConstants, ConfinedEnergyIsThatOfAUnitStrainAlongOneAxis) {
  for (const BondSetting& setting : settings) {
    const double classical = classical_energy(setting, {1, 0, 0, 0, 0, 0}) / youngs_modulus;
    EXPECT_NEAR(confined_energy_per_modulus(setting), classical, 1e-15);
  }
}

TEST(BondConstants, PoissonRatioLeavesTheTransverseStressFree) {
  // Under uniaxial stress the energy is least: d(energy)/d(transverse strain) = 0 by central
  // difference, exact for a quadratic energy.
  for (const BondSetting& setting : settings) {
    const double nu = poisson_ratio(setting);
    if (setting.dimension == 1) {
      EXPECT_EQ(nu, 0.0);
      continue;
    }
    const double modulus = micromodulus(youngs_modulus, setting);
    const bool in_space = setting.dimension == 3;
    // Plane strain holds the strain across the plane at zero, so that the ratio in the plane is
    // nu/(1 - nu).
    const bool plane_strain = setting.dimension == 2 && setting.plane == PlaneState::strain;
    const double transverse = plane_strain ? -nu / (1.0 - nu) : -nu;
    const auto energy = [&](double more) {
      const double e = transverse + more;
      return peridynamic_energy(setting, modulus, {1, e, in_space ? e : 0.0, 0, 0, 0});
    };
    ASSERT_GT(energy(0.0), 0.1);
    EXPECT_NEAR((energy(0.5) - energy(-0.5)) / energy(0.0), 0.0, quadrature_error);
    EXPECT_GT(energy(0.5) / energy(0.0), 1.05);
  }
}

TEST(BondConstants, YoungsModulusIsTheInverse) {
  for (const BondSetting& setting : settings) {
    EXPECT_NEAR(youngs_modulus_of(micromodulus(youngs_modulus, setting), setting), youngs_modulus,
                1e-15 * youngs_modulus);
  }
}

}  // namespace
}  // namespace peristat
