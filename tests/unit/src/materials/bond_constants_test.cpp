#include "src/materials/bond_constants.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "tests/bodies.hpp"

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

const BondSetting settings[] = {{{1, 0.3, 0.02}, PlaneState::stress},
                                {{2, 0.3, 0.02}, PlaneState::stress},
                                {{2, 0.3, 0.02}, PlaneState::strain},
                                {{3, 0.3, 1.0}, PlaneState::stress}};

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

/// Energy of the bonds over a unit of area, c s^2 |xi| / 2 each: for a bond vector xi the points
/// whose bonds pass it stand in a layer as thick as xi is across the area.
double energy_over_area(const BondSetting& setting, double modulus, double stretch) {
  constexpr int shells = 2000;
  double radial = 0.0;
  for (int k = 0; k < shells; ++k) {
    const double r = (k + 0.5) * setting.horizon / shells;
    radial += r * r * std::pow(r, setting.dimension - 1) * setting.horizon / shells;
  }
  double across = 0.0;
  for (const auto& [n, angle] : directions(setting.dimension)) {
    across += angle * std::max(n[2 * (setting.dimension == 3)], 0.0);
  }
  const double section = setting.dimension == 3 ? 1.0 : setting.cross_section;
  return 0.5 * modulus * stretch * stretch * radial * across * section;
}

TEST(BondConstants, BrittleBondsTakeTheFractureEnergy) {
  for (const BondSetting& setting : settings) {
    const double c = micromodulus(youngs_modulus, setting), energy = 3.7;
    const double s = critical_stretch(energy, c, setting);
    // Sixteen directions around a circle leave 1.3 % of |n_x|, two thousand over a sphere 1e-7.
    const double tolerance = setting.dimension == 2 ? 0.014 : quadrature_error;
    EXPECT_NEAR(energy_over_area(setting, c, s) / energy, 1.0, tolerance);
  }
  // [GPMB] eq. 10 and its plane counterpart.
  const double delta = 0.3, h = 0.02, c = 2.5e9, energy = 3.7;
  EXPECT_NEAR(critical_stretch(energy, c, {3, delta, 1.0}),
              std::sqrt(10.0 * energy / (pi * c * std::pow(delta, 5))), 1e-14);
  EXPECT_NEAR(critical_stretch(energy, c, {2, delta, h}),
              std::sqrt(4.0 * energy / (c * h * std::pow(delta, 4))), 1e-14);
}

TEST(BondConstants, AreThoseOfTheBooks) {
  const double e = youngs_modulus, d = 0.3, h = 0.02;
  const double books[] = {2.0 * e / (h * d * d), 9.0 * e / (pi * d * d * d * h),
                          48.0 * e / (5.0 * pi * d * d * d * h), 12.0 * e / (pi * d * d * d * d)};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(micromodulus(e, settings[k]) / books[k], 1.0, 1e-14);
}

// Under the same stretch of all bonds the mean over directions is every direction's: with the
// moment of the lattice its energy is classical to round-off, whatever the influence function.
TEST(BondConstants, OfALatticeGiveItTheClassicalEnergyOfADilation) {
  for (const int dimension : {2, 3}) {
    for (const bool conical : {false, true}) {
      tests::BoxSetting box = tests::small_box(dimension);
      box.extent = {9, 9, dimension == 3 ? 9 : 0};
      box.quadrature.volume = VolumeCorrection::linear;
      const Points points = tests::box_points(box);
      BondSetting setting = tests::bond_setting(box);
      if (conical) setting.influence = [](double ratio) { return 1.0 - 0.7 * ratio; };
      const double c = lattice_micromodulus(youngs_modulus, setting, box.spacing);
      EXPECT_GT(std::abs(c / micromodulus(youngs_modulus, setting) - 1.0), 1e-3);
      const Model model(make_bonds(points, SurfaceCorrection::none, setting, 1), Harmonic{c});
      constexpr double strain = 1e-3;
      std::vector<double> displacement = points.reference, energies(points.volume.size());
      for (double& entry : displacement) entry *= strain;
      Assembler(points, model, 1).point_energies(displacement, energies);
      const double classical =
          classical_energy(setting, {strain, strain, dimension == 3 ? strain : 0.0, 0, 0, 0});
      int inside = 0;
      for (Index i = 0; i < points.count(); ++i) {
        if (!tests::is_inside(points, i, box, setting.horizon + box.spacing)) continue;
        EXPECT_NEAR(energies[i] / points.volume[i] / classical, 1.0, 1e-11);
        ++inside;
      }
      EXPECT_GT(inside, 0);
    }
  }
}

// The same on cells that are not square, under a lattice that is turned: the bulk's sums are those
// of the lattice as it is. Round-off of a hundred bonds.
TEST(BondConstants, OfATurnedOblongLatticeGiveItTheClassicalEnergyOfADilation) {
  for (const int dimension : {2, 3}) {
    for (const double angle : {0.0, 30.0}) {
      Lattice lattice;
      lattice.dimension = dimension;
      lattice.spacing = Spacing({0.1, 0.14, 0.12}, dimension);
      lattice.angle = angle;
      lattice.shapes = {{ShapeStep::Action::add, Box{{-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9}}}};
      const Points points = make_points(lattice);
      const BondSetting setting{{dimension, 3.05 * points.spacing, 1.0}, PlaneState::stress};
      const double c = lattice_micromodulus(youngs_modulus, setting, points.spacing);
      EXPECT_GT(std::abs(c / lattice_micromodulus(youngs_modulus, setting, 0.1) - 1.0), 1e-3);
      const Model model(make_bonds(points, SurfaceCorrection::none, setting, 1), Harmonic{c});
      constexpr double strain = 1e-3;
      std::vector<double> displacement = points.reference, energies(points.volume.size());
      for (double& entry : displacement) entry *= strain;
      Assembler(points, model, 1).point_energies(displacement, energies);
      const double classical =
          classical_energy(setting, {strain, strain, dimension == 3 ? strain : 0.0, 0, 0, 0});
      int inside = 0;
      for (Index i = 0; i < points.count(); ++i) {
        const Coordinates at = points.position(i);
        const double depth = 0.9 - std::max({std::abs(at[0]), std::abs(at[1]), std::abs(at[2])});
        if (depth < setting.horizon + 0.15) continue;
        EXPECT_NEAR(energies[i] / points.volume[i] / classical, 1.0, 1e-12);
        ++inside;
      }
      EXPECT_GT(inside, 0);
    }
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
