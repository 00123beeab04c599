#include "src/neighbourhood/influence.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "src/materials/bond_constants.hpp"

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi, delta = 0.3, h = 0.02;

/// int_0^delta omega r^k dr / delta^(k+1) for k = 2, 3, 4: [GPMB] eqs. C12, C21 and D29.
const std::map<std::string, std::array<double, 3>> published{
    {"constant", {1.0 / 3, 1.0 / 4, 1.0 / 5}},
    {"piecewise_constant", {1.0 / 3, 1.0 / 4, 1.0 / 5}},
    {"linear", {1.0 / 12, 1.0 / 20, 1.0 / 30}},
    {"cubic", {1.0 / 15, 1.0 / 28, 3.0 / 140}},
    {"quintic", {5.0 / 84, 5.0 / 168, 1.0 / 60}},
    {"septic", {1.0 / 18, 7.0 / 264, 7.0 / 495}}};

/// c h delta^3 / E in plane strain and plane stress: Table 2.
const std::map<std::string, std::array<double, 2>> micromoduli{
    {"constant", {48.0 / (5.0 * pi), 9.0 / pi}},
    {"piecewise_constant", {48.0 / (5.0 * pi), 9.0 / pi}},
    {"linear", {192.0 / (5.0 * pi), 36.0 / pi}},
    {"cubic", {48.0 / pi, 45.0 / pi}},
    {"quintic", {1344.0 / (25.0 * pi), 252.0 / (5.0 * pi)}},
    {"septic", {288.0 / (5.0 * pi), 54.0 / pi}}};

/// s_0^2 E delta / (pi G_0): Table 3.
const std::map<std::string, std::array<double, 2>> squared_stretches{
    {"constant", {5.0 / 12, 4.0 / 9}}, {"piecewise_constant", {5.0 / 12, 4.0 / 9}},
    {"linear", {25.0 / 48, 5.0 / 9}},  {"cubic", {7.0 / 12, 28.0 / 45}},
    {"quintic", {5.0 / 8, 2.0 / 3}},   {"septic", {55.0 / 84, 44.0 / 63}}};

BondSetting setting_of(const std::string& influence, int dimension,
                       PlaneState plane = PlaneState::stress) {
  BondSetting setting{{dimension, delta, dimension == 3 ? 1.0 : h}, plane};
  setting.influence = influence_named(influence);
  return setting;
}

// A relative 1e-14 is some tens of round-offs.
TEST(Influence, HasThePublishedMoments) {
  int compared = 0;
  for (const auto& [name, moments] : published) {
    const BondSetting setting = setting_of(name, 2);
    for (int k = 2; k <= 4; ++k) {
      const double moment = 2.0 * pi * h * std::pow(delta, k + 1) * moments.at(std::size_t(k - 2));
      EXPECT_NEAR(setting.moment(k - 1) / moment, 1.0, 1e-14) << name;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 18);
}

TEST(Influence, GivesTheMicromoduliOfTheBooks) {
  for (const auto& [name, factors] : micromoduli) {
    for (const PlaneState plane : {PlaneState::strain, PlaneState::stress}) {
      const double book =
          factors.at(std::size_t(plane == PlaneState::stress)) / (h * delta * delta * delta);
      EXPECT_NEAR(micromodulus(1.0, setting_of(name, 2, plane)) / book, 1.0, 1e-14) << name;
    }
  }
}

TEST(Influence, GivesTheCriticalStretchesOfTheBooks) {
  const double modulus = 3e9, energy = 12.0;
  for (const auto& [name, factors] : squared_stretches) {
    for (const PlaneState plane : {PlaneState::strain, PlaneState::stress}) {
      const BondSetting setting = setting_of(name, 2, plane);
      const double book = std::sqrt(factors.at(std::size_t(plane == PlaneState::stress)) * pi *
                                    energy / (modulus * delta));
      const double found = critical_stretch(energy, micromodulus(modulus, setting), setting);
      EXPECT_NEAR(found / book, 1.0, 1e-14) << name;
    }
  }
}

// Closed forms: int x^p (1 - x) = 1/((p+1)(p+2)), int x^(p-1) = 1/p, int x exp(-x^2) = (1 - 1/e)/2,
// int x^3 exp(-x^2) = 1/2 - 1/e.
TEST(Influence, GivesConstantsOfBarsAndSolids) {
  EXPECT_NEAR(micromodulus(1.0, setting_of("linear", 1)) * h * delta * delta, 6.0, 1e-13);
  EXPECT_NEAR(micromodulus(1.0, setting_of("inverse", 1)) * h * delta * delta, 1.0, 1e-14);
  EXPECT_NEAR(micromodulus(1.0, setting_of("linear", 3)) * pi * std::pow(delta, 4), 60.0, 1e-12);
  EXPECT_NEAR(micromodulus(1.0, setting_of("inverse", 3)) * pi * std::pow(delta, 4), 9.0, 1e-13);
  const double e = std::numbers::e;
  EXPECT_NEAR(micromodulus(1.0, setting_of("gaussian", 1)) * h * delta * delta,
              1.0 / (0.5 * (1.0 - 1.0 / e)), 1e-13);
  EXPECT_NEAR(micromodulus(1.0, setting_of("gaussian", 3)) * pi * std::pow(delta, 4),
              3.0 / (0.5 - 1.0 / e), 1e-12);
}

// What [GPMB] prints as sums of powers.
TEST(Influence, IsThePublishedPolynomial) {
  for (const double x : {0.0, 0.1, 0.35, 0.6, 0.99}) {
    const double x2 = x * x, x3 = x2 * x, x4 = x2 * x2, x5 = x4 * x;
    const std::map<std::string, double> values{
        {"linear", 1 - x},
        {"cubic", 1 - 3 * x2 + 2 * x3},
        {"quintic", 1 - 10 * x3 + 15 * x4 - 6 * x5},
        {"septic", 1 - 35 * x4 + 84 * x5 - 70 * x5 * x + 20 * x5 * x2}};
    for (const auto& [name, value] : values) {
      EXPECT_NEAR(influence_named(name)(x), value, 1e-14) << name;
      EXPECT_EQ(influence_named(name)(1.0 + x), 0.0) << name;
    }
  }
  EXPECT_FALSE(influence_named("constant"));
  EXPECT_FALSE(influence_named("unheard-of"));
}

// Points at exactly the horizon, whatever the round-off of their distance.
TEST(Influence, TakesRoundOffAtTheHorizonForTheHorizon) {
  for (const double distance : {delta * (1.0 - 1e-12), delta, delta * (1.0 + 1e-12)}) {
    EXPECT_EQ(setting_of("linear", 2).influence_at(distance), 0.0);
    EXPECT_EQ(setting_of("septic", 2).influence_at(distance), 0.0);
    EXPECT_EQ(setting_of("piecewise_constant", 2).influence_at(distance), 1.0);
    EXPECT_EQ(setting_of("inverse", 2).influence_at(distance), 1.0);
  }
  EXPECT_EQ(setting_of("piecewise_constant", 2).influence_at(1.01 * delta), 0.0);
  EXPECT_GT(setting_of("gaussian", 2).influence_at(1.01 * delta), 0.36);
}

}  // namespace
}  // namespace peristat
