#include "src/materials/directed_constant.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "src/materials/interface_rule.hpp"

namespace peristat {
namespace {

BondSetting setting_of(int dimension) {
  BondSetting setting;
  setting.dimension = dimension;
  setting.horizon = 0.37;
  setting.cross_section = dimension == 2 ? 0.2 : 1.0;
  return setting;
}

constexpr double pi = std::numbers::pi;

/// Moduli of the energy W = m_1/4 <c (n e n)^2> of homogeneous strains, by sums over directions:
/// stiffness of normal strains along f, across it and, in 3D, across both.
std::array<std::array<double, 3>, 3> stiffness(const DirectedConstant& c,
                                               const BondSetting& setting, double* shear) {
  std::array<std::array<double, 3>, 3> result{};
  *shear = 0.0;
  double total = 0.0;
  const bool is_plane = setting.dimension == 2;
  const int around = 64, up = is_plane ? 1 : 400;
  for (int k = 0; k < around; ++k) {
    for (int l = 0; l < up; ++l) {
      const double angle = 2.0 * pi * (k + 0.5) / around;
      const double z = is_plane ? 0.0 : -1.0 + 2.0 * (l + 0.5) / up;
      const double flat = std::sqrt(1.0 - z * z);
      const Coordinates n{flat * std::cos(angle), flat * std::sin(angle), z};
      const double here = c.at(c.alignment(n));
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) result[a][b] += here * n[a] * n[a] * n[b] * n[b];
      }
      *shear += here * n[0] * n[0] * n[1] * n[1];
      total += 1.0;
    }
  }
  const double scale = 0.5 * setting.moment(1) / total;
  for (auto& row : result) {
    for (double& entry : row) entry *= scale;
  }
  *shear *= scale;
  return result;
}

/// 1 / (C^-1)_kk of the normal components, the others being free of stress.
double youngs_modulus(const std::array<std::array<double, 3>, 3>& c, int k, bool is_plane) {
  const int a = (k + 1) % 3, b = (k + 2) % 3;
  if (is_plane) {
    const int other = 1 - k;
    return c[k][k] - c[k][other] * c[other][k] / c[other][other];
  }
  const double minor = c[a][a] * c[b][b] - c[a][b] * c[b][a];
  return c[k][k] - (c[k][a] * (c[b][b] * c[a][k] - c[a][b] * c[b][k]) +
                    c[k][b] * (c[a][a] * c[b][k] - c[b][a] * c[a][k])) /
                       minor;
}

TEST(DirectedConstant, HasTheModuliThatAreAskedFor) {
  for (const int dimension : {2, 3}) {
    const BondSetting setting = setting_of(dimension);
    for (const auto& moduli :
         {FibreModuli{8.0, 2.0, 1.6}, FibreModuli{1.0, 3.0, 0.7}, FibreModuli{30e9, 9e9, 7e9}}) {
      const auto c = directed_micromodulus(moduli, {1.0, 0.0, 0.0}, setting);
      EXPECT_GT(c.least(), 0.0);
      double shear = 0.0;
      const auto matrix = stiffness(c, setting, &shear);
      // The sum over 400 heights of the sphere is off by their square.
      const double tolerance = dimension == 2 ? 1e-13 : 1e-4;
      const bool is_plane = dimension == 2;
      EXPECT_NEAR(youngs_modulus(matrix, 0, is_plane) / moduli.along, 1.0, tolerance);
      EXPECT_NEAR(youngs_modulus(matrix, 1, is_plane) / moduli.across, 1.0, tolerance);
      EXPECT_NEAR(shear / moduli.shear, 1.0, tolerance);
    }
  }
}

TEST(DirectedConstant, OfEqualModuliIsTheIsotropicOne) {
  for (const int dimension : {2, 3}) {
    const BondSetting setting = setting_of(dimension);
    const double e = 5.0, expected = micromodulus(e, setting);
    const auto c =
        directed_micromodulus({e, e, natural_shear(e, e, setting)}, {0.6, 0.8, 0.0}, setting);
    for (const double t : {0.0, 0.3, 0.9, 1.0}) EXPECT_NEAR(c.at(t) / expected, 1.0, 1e-13);
  }
}

TEST(DirectedConstant, FollowsTheFibres) {
  const DirectedConstant c{{1.0, 2.0, 3.0}, {0.6, 0.8, 0.0}};
  EXPECT_NEAR(c.alignment({0.6, 0.8, 0.0}), 1.0, 1e-15);
  EXPECT_NEAR(c.alignment({-0.6, -0.8, 0.0}), 1.0, 1e-15);
  EXPECT_NEAR(c.alignment({-0.8, 0.6, 0.0}), 0.0, 1e-15);
}

TEST(DirectedConstant, KnowsItsLeast) {
  EXPECT_DOUBLE_EQ((DirectedConstant{{1.0, -2.0, 2.0}, {}}).least(), 0.5);
  EXPECT_DOUBLE_EQ((DirectedConstant{{1.0, 2.0, -2.5}, {}}).least(), 0.5);
  EXPECT_DOUBLE_EQ((DirectedConstant{{1.0, 2.0, 2.0}, {}}).least(), 1.0);
}

TEST(DirectedConstant, TellsWhichShearModuliItCanHave) {
  for (const int dimension : {2, 3}) {
    const BondSetting setting = setting_of(dimension);
    const double ratio = dimension == 2 ? 14.0 : 10.0;
    const FibreModuli strong{ratio, 1.0, natural_shear(ratio, 1.0, setting)};
    EXPECT_LT(directed_micromodulus(strong, {1.0, 0.0, 0.0}, setting).least(), 0.0);
    const auto [least, most] = possible_shear(strong, setting);
    ASSERT_GT(least, 0.0);
    for (const double shear : {least, most}) {
      const auto inside = directed_micromodulus({ratio, 1.0, shear}, {1.0, 0.0, 0.0}, setting);
      EXPECT_GT(inside.least(), 0.0);
      const double beyond = shear == least ? 0.98 * shear : 1.02 * shear;
      const auto outside = directed_micromodulus({ratio, 1.0, beyond}, {1.0, 0.0, 0.0}, setting);
      EXPECT_LT(outside.least(), 0.0);
    }
  }
}

TEST(InterfaceRule, MakesMeansOfConstants) {
  const std::array constants{2.0, 6.0};
  EXPECT_DOUBLE_EQ(mean_by(InterfaceRule::harmonic, constants), 3.0);
  EXPECT_DOUBLE_EQ(mean_by(InterfaceRule::arithmetic, constants), 4.0);
  EXPECT_DOUBLE_EQ(mean_by(InterfaceRule::weaker, constants), 2.0);
  EXPECT_EQ(mean_by(InterfaceRule::harmonic, std::array{0.0, 6.0, 1.0}), 0.0);
}

}  // namespace
}  // namespace peristat
