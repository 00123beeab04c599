#include "src/materials/cpd_constants.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/influence.hpp"

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi;
using Strain = std::array<std::array<double, 3>, 3>;
using Arm = std::array<double, 3>;

Arm deformed(const Arm& arm, const Strain& strain) {
  Arm result = arm;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) result[r] += strain[r][c] * arm[c];
  }
  return result;
}

double volume_of(const Arm& b, const Arm& c, const Arm& d) {
  return b[0] * (c[1] * d[2] - c[2] * d[1]) + b[1] * (c[2] * d[0] - c[0] * d[2]) +
         b[2] * (c[0] * d[1] - c[1] * d[0]);
}

double area_of(const Arm& b, const Arm& c) {
  return std::hypot(b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2],
                    b[0] * c[1] - b[1] * c[0]);
}

double length_of(const Arm& b) { return std::hypot(b[0], b[1], b[2]); }

/// Energy density of a lattice point far from surfaces (eq. 14 of [CPD]): the loops over ordered
/// neighbours, pairs and triplets as printed, with measures of the deformed arms.
/// @param omega of a length over the horizon
double energy_density(int dimension, double spacing, double horizon, double thickness,
                      const CpdConstants& constants, const Strain& strain,
                      const std::function<double(double)>& omega) {
  std::vector<Arm> arms;
  const int width = int(horizon / spacing) + 1;
  for (int x = -width; x <= width; ++x) {
    for (int y = -width; y <= width; ++y) {
      for (int z = dimension == 3 ? -width : 0; z <= (dimension == 3 ? width : 0); ++z) {
        const Arm arm{spacing * x, spacing * y, spacing * z};
        const double length = length_of(arm);
        if (length > 0.0 && length < horizon * (1 + 1e-9)) arms.push_back(arm);
      }
    }
  }
  const auto near = [&](const Arm& a, const Arm& b) {
    return length_of({a[0] - b[0], a[1] - b[1], a[2] - b[2]}) < horizon * (1 + 1e-9);
  };
  const auto influence = [&](const Arm& a, const Arm& b) {
    return omega(length_of({a[0] - b[0], a[1] - b[1], a[2] - b[2]}) / horizon);
  };
  const Arm here{};
  double psi1 = 0.0, psi2 = 0.0, psi3 = 0.0, pairs = 0.0, triplets = 0.0;
  for (const Arm& b : arms) {
    const double length = length_of(b), s = length_of(deformed(b, strain)) / length - 1.0;
    psi1 += 0.5 * constants.c1 * length * s * s * influence(here, b);
    for (const Arm& c : arms) {
      const double area = area_of(b, c);
      if (!near(b, c)) continue;
      if (area > 1e-9 * horizon * horizon) {
        const double e = area_of(deformed(b, strain), deformed(c, strain)) / area - 1.0;
        ++pairs;
        psi2 += 0.5 * constants.c2 * area * e * e * influence(here, b) * influence(here, c) *
                influence(b, c);
      }
      if (dimension == 2) continue;
      for (const Arm& d : arms) {
        if (!near(b, d) || !near(c, d)) continue;
        const double volume = volume_of(b, c, d);
        if (std::abs(volume) < 1e-9 * std::pow(horizon, 3)) continue;
        const double e =
            volume_of(deformed(b, strain), deformed(c, strain), deformed(d, strain)) / volume - 1.0;
        ++triplets;
        psi3 += 0.5 * constants.c3 * std::abs(volume) * e * e * influence(here, b) *
                influence(here, c) * influence(here, d) * influence(b, c) * influence(b, d) *
                influence(c, d);
      }
    }
  }
  const double v_h =
      dimension == 2 ? pi * horizon * horizon * thickness : 4.0 / 3.0 * pi * std::pow(horizon, 3);
  double density = 0.5 * v_h / double(arms.size()) * psi1 + v_h * v_h / pairs / 3.0 * psi2;
  if (dimension == 3) density += std::pow(v_h, 3) / triplets / 4.0 * psi3;
  return density;
}

struct Setting {
  int dimension;
  double horizon_ratio, thickness;
  std::string influence = "constant";
};

void PrintTo(const Setting& setting, std::ostream* out) {
  *out << setting.dimension << "D, horizon ratio " << setting.horizon_ratio << ", "
       << setting.influence;
}

std::string lattice_name(const ::testing::TestParamInfo<Setting>& tested) {
  return std::to_string(tested.param.dimension) + "DRatio" +
         std::to_string(std::lround(1000.0 * tested.param.horizon_ratio)) + tested.param.influence;
}

class LatticeStiffness : public ::testing::TestWithParam<Setting> {};

TEST_P(LatticeStiffness, IsTheSecondDifferenceOfTheEnergyDensity) {
  const auto& [dimension, ratio, thickness, influence] = GetParam();
  constexpr double spacing = 0.5;
  const double horizon = ratio * spacing;
  Kernel kernel{dimension, horizon, thickness};
  kernel.influence = influence_named(influence);
  const CpdStiffness stiffness = lattice_stiffness(kernel, spacing);
  const auto omega = [&](double x) { return kernel.influence ? kernel.influence(x) : 1.0; };
  // Each constant alone, of a size that makes the energy of order one.
  const double size = horizon * thickness;
  for (const CpdConstants& constants :
       {CpdConstants{1.0 / size, 0.0, 0.0}, CpdConstants{0.0, 1.0 / std::pow(size, 2), 0.0},
        CpdConstants{0.0, 0.0, dimension == 3 ? 1.0 : 0.0}}) {
    if (constants.c1 + constants.c2 + constants.c3 == 0.0) continue;
    const CubicElasticity elasticity = stiffness.elasticity(constants);
    // 2 W / h^2 for small strains h; the mean over +h and -h leaves an error of order h^2.
    const auto modulus = [&](Strain unit) {
      constexpr double h = 1e-4;
      double sum = 0.0;
      for (double sign : {-h, h}) {
        Strain strain{};
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 3; ++c) strain[r][c] = sign * unit[r][c];
        }
        sum += energy_density(dimension, spacing, horizon, thickness, constants, strain, omega);
      }
      return sum / (h * h);
    };
    Strain along{}, both{}, shear{};
    along[0][0] = 1.0;
    both[0][0] = both[1][1] = 1.0;
    shear[0][1] = shear[1][0] = 0.5;
    const double scale = elasticity.c11;
    ASSERT_GT(scale, 0.0);
    EXPECT_NEAR(elasticity.c11, modulus(along), 1e-6 * scale);
    EXPECT_NEAR(2.0 * (elasticity.c11 + elasticity.c12), modulus(both), 1e-6 * scale);
    EXPECT_NEAR(elasticity.c44, modulus(shear), 1e-6 * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(Lattices, LatticeStiffness,
                         ::testing::Values(Setting{2, 2.015, 1.0}, Setting{2, 3.015, 0.3},
                                           Setting{3, 1.5, 1.0}, Setting{3, 2.015, 1.0},
                                           Setting{2, 3.015, 0.3, "cubic"},
                                           Setting{3, 2.015, 1.0, "gaussian"}),
                         lattice_name);

/// Largest relative deviation of the isotropic parts from the continuum's, per constant.
std::array<double, 3> deviation(int dimension, double ratio) {
  const double horizon = 0.7, thickness = dimension == 2 ? 0.2 : 1.0;
  const CpdStiffness lattice = lattice_stiffness(dimension, horizon / ratio, horizon, thickness);
  const CpdStiffness continuum = continuum_stiffness(dimension, horizon, thickness);
  const auto of = [&](const CubicElasticity& a, const CubicElasticity& b) {
    const LameModuli x = a.isotropic(dimension), y = b.isotropic(dimension);
    return std::max(std::abs(x.lambda - y.lambda), std::abs(x.mu - y.mu)) / y.lambda;
  };
  return {of(lattice.of_c1, continuum.of_c1), of(lattice.of_c2, continuum.of_c2),
          dimension == 3 ? of(lattice.of_c3, continuum.of_c3) : 0.0};
}

TEST(LatticeStiffnessLimit, IsTheContinuumsForGrowingHorizonRatio) {
  // Sums over cells against integrals: errors fall with the ratio, at rate 1 and irregularly.
  const std::array<double, 3> coarse = deviation(2, 2.5), fine = deviation(2, 24.0);
  for (int k : {0, 1}) {
    EXPECT_LT(fine[k], 0.03) << k;
    EXPECT_LT(fine[k], 0.5 * coarse[k]) << k;
  }
  const std::array<double, 3> coarse_3d = deviation(3, 2.0), fine_3d = deviation(3, 7.0);
  const std::array<double, 3> bound{0.03, 0.1, 0.25};
  for (int k : {0, 1, 2}) {
    EXPECT_LT(fine_3d[k], bound[k]) << k;
    EXPECT_LT(fine_3d[k], 0.5 * coarse_3d[k]) << k;
  }
}

// Measured independently of this code when the formulas were derived.
TEST(LatticeStiffnessLimit, IsFarFromTheContinuumOnCoarseLattices) {
  const auto lambda_ratio = [](int dimension, double ratio, CubicElasticity CpdStiffness::*part) {
    return (lattice_stiffness(dimension, 1.0, ratio, 1.0).*part).isotropic(dimension).lambda /
           (continuum_stiffness(dimension, ratio, 1.0).*part).isotropic(dimension).lambda;
  };
  EXPECT_NEAR(lambda_ratio(2, 3.0, &CpdStiffness::of_c2), 1.376, 5e-4);
  EXPECT_NEAR(lambda_ratio(3, 2.0, &CpdStiffness::of_c3), 1.974, 5e-4);
}

TEST(ContinuumStiffness, HasThePoissonRatiosOfCentralForcesAndTheIncompressibleLimits) {
  const CpdStiffness plane = continuum_stiffness(2, 0.3, 0.1),
                     solid = continuum_stiffness(3, 0.3, 1);
  EXPECT_NEAR(poisson_ratio_of(plane.moduli({1.0, 0.0, 0.0}), 2), 1.0 / 3.0, 1e-14);
  EXPECT_NEAR(poisson_ratio_of(solid.moduli({1.0, 0.0, 0.0}), 3), 0.25, 1e-14);
  double before_2d = 1.0 / 3.0, before_3d = 0.25;
  for (double c = 1e2; c < 1e30; c *= 1e3) {
    const double nu_2d = poisson_ratio_of(plane.moduli({1.0, c, 0.0}), 2);
    const double nu_3d = poisson_ratio_of(solid.moduli({1.0, 0.0, c}), 3);
    EXPECT_GE(nu_2d, before_2d);
    EXPECT_GE(nu_3d, before_3d);
    before_2d = nu_2d;
    before_3d = nu_3d;
  }
  EXPECT_NEAR(before_2d, 1.0, 1e-9);
  EXPECT_NEAR(before_3d, 0.5, 1e-9);
  // Triangles alone resist shear too in 3D: lambda = 6 mu, nu = 3/7.
  EXPECT_NEAR(poisson_ratio_of(solid.moduli({0.0, 1.0, 0.0}), 3), 3.0 / 7.0, 1e-9);
}

TEST(ContinuumStiffness, HasTheMeanAreasAndVolumesOfNumericalIntegration) {
  // 2D: lambda = V_H^2 <A> / 3 per C2.
  const double mean_area = 5.0 / (3.0 * (4.0 * pi - 3.0 * std::sqrt(3.0)));
  const double lambda = continuum_stiffness(2, 1.0, 1.0).of_c2.isotropic(2).lambda;
  EXPECT_NEAR(lambda, pi * pi * mean_area / 3.0, 1e-14);
  EXPECT_NEAR(lambda, 0.743955390950, 1e-12);
  // 3D, found independently by numerical integration (the last by Monte Carlo, to four digits).
  const CpdStiffness solid = continuum_stiffness(3, 1.0, 1.0);
  EXPECT_NEAR(solid.of_c2.isotropic(3).mu, 0.139553047382, 1e-12);
  EXPECT_NEAR(solid.of_c2.isotropic(3).lambda, 0.837318284291, 1e-12);
  EXPECT_NEAR(solid.of_c3.isotropic(3).lambda, 1.81514, 1e-4);
}

TEST(CpdConstants, AndModuliAreInversesOfEachOther) {
  for (int dimension : {2, 3}) {
    for (const CpdStiffness& stiffness :
         {continuum_stiffness(dimension, 0.3, dimension == 2 ? 0.1 : 1),
          lattice_stiffness(dimension, 0.1, 0.2015, dimension == 2 ? 0.1 : 1)}) {
      for (double nu : {-0.9, -0.3, 0.0, 0.25, 0.45}) {
        const LameModuli moduli = lame_moduli(210e9, nu, dimension);
        EXPECT_NEAR(youngs_modulus_of(moduli, dimension) / 210e9, 1.0, 1e-13);
        EXPECT_NEAR(poisson_ratio_of(moduli, dimension), nu, 1e-14);
        for (double share : {0.0, 0.4, -0.4}) {
          if (dimension == 2 && share != 0.0) continue;
          const double c2 = share * moduli.mu / stiffness.of_c2.isotropic(3).mu;
          const CpdConstants constants = stiffness.constants(moduli, c2);
          EXPECT_GT(constants.c1, 0.0);
          EXPECT_EQ(dimension == 3 ? constants.c2 : constants.c3, dimension == 3 ? c2 : 0.0);
          const LameModuli back = stiffness.moduli(constants);
          EXPECT_NEAR(back.mu / moduli.mu, 1.0, 1e-12);
          EXPECT_NEAR(back.lambda, moduli.lambda, 1e-12 * moduli.mu);
        }
      }
    }
  }
}

TEST(CpdConstants, OfTheRatioOfCentralForcesAreZeroWhateverTheLastDigit) {
  for (int dimension : {2, 3}) {
    const double thickness = dimension == 2 ? 0.1 : 1.0, ratio = dimension == 2 ? 1.0 / 3.0 : 0.25;
    for (double spacing : {0.1, 1e-3, 0.37}) {
      for (double horizon_ratio : {1.5, 2.015, 3.015}) {
        for (const CpdStiffness& stiffness :
             {continuum_stiffness(dimension, horizon_ratio * spacing, thickness),
              lattice_stiffness(dimension, spacing, horizon_ratio * spacing, thickness)}) {
          const auto last = [&](double nu) {
            const CpdConstants found = stiffness.constants(lame_moduli(210e9, nu, dimension), 0.0);
            return dimension == 2 ? found.c2 : found.c3;
          };
          for (double nu : {ratio, ratio * (1.0 - 4e-16), ratio * (1.0 + 4e-16)}) {
            EXPECT_EQ(last(nu), 0.0);
          }
          EXPECT_LT(last(ratio - 1e-8), 0.0);
          EXPECT_GT(last(ratio + 1e-8), 0.0);
        }
      }
    }
  }
}

TEST(CpdConstants, ThatNeedInteractionsBeyondTheHorizonAreRefused) {
  for (int dimension : {2, 3}) {
    const CpdStiffness stiffness = lattice_stiffness(dimension, 0.1, 0.12, 1.0);
    EXPECT_THROW((void)stiffness.constants(lame_moduli(1.0, 0.4, dimension), 0.0), InputError);
    const LameModuli of_bonds = stiffness.moduli({1.0, 0.0, 0.0});
    EXPECT_NEAR(stiffness.constants(of_bonds, 0.0).c1, 1.0, 1e-13);
  }
}

TEST(CpdConstants, OutsideTheStableRangeAreRefused) {
  for (int dimension : {2, 3}) {
    for (double nu : {-1.0, -1.5, dimension == 2 ? 1.0 : 0.5, 2.0, std::nan("")}) {
      EXPECT_THROW((void)lame_moduli(1.0, nu, dimension), InputError) << nu;
    }
    EXPECT_THROW((void)lame_moduli(0.0, 0.2, dimension), InputError);
    EXPECT_THROW((void)lame_moduli(-1.0, 0.2, dimension), InputError);
    EXPECT_NO_THROW(require_stable({-0.5, 1.0}, dimension));
    EXPECT_THROW(require_stable({-1.1, 1.0}, dimension), InputError);
    EXPECT_THROW(require_stable({1.0, 0.0}, dimension), InputError);
  }
  const CpdStiffness stiffness = continuum_stiffness(3, 0.3, 1.0);
  const LameModuli moduli = lame_moduli(1.0, 0.3, 3);
  const double most = moduli.mu / stiffness.of_c2.isotropic(3).mu;
  EXPECT_NO_THROW((void)stiffness.constants(moduli, 0.99 * most));
  EXPECT_THROW((void)stiffness.constants(moduli, 1.01 * most), InputError);
}

TEST(BulkNeighbourhood, CountsNeighboursPairsAndTriplets) {
  // Horizon of one spacing and a half in the plane: the 8 cells around. A neighbour at an edge (4)
  // has 4 of the others within the horizon, one at a corner (4) has 2; pairs opposite each other
  // are out of reach, so none is collinear.
  const BulkNeighbourhood plane = bulk_neighbourhood(2, 2.0, 3.0, 0.5);
  EXPECT_EQ(plane.neighbours, 8);
  EXPECT_EQ(plane.pairs, 4 * 4 + 4 * 2);
  EXPECT_EQ(plane.triplets, 0);
  EXPECT_NEAR(plane.volume, 0.5 * pi * 9.0, 1e-14);
  EXPECT_EQ(bulk_neighbourhood(3, 1.0, 3.015, 1.0).neighbours, 122);
  // Horizon of one spacing: no two neighbours are within it of each other.
  const BulkNeighbourhood solid = bulk_neighbourhood(3, 1.0, 1.0, 1.0);
  EXPECT_EQ(solid.neighbours, 6);
  EXPECT_EQ(solid.pairs, 0);
  EXPECT_EQ(solid.triplets, 0);
}

}  // namespace
}  // namespace peristat
