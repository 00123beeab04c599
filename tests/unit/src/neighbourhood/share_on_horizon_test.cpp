#include "src/neighbourhood/share_on_horizon.hpp"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

/// Bonds of the given lengths [m].
Bonds bonds_of(const std::vector<double>& lengths) {
  std::vector<Index> upper(lengths.size());
  std::iota(upper.begin(), upper.end(), 1);
  Bonds bonds = tests::bonds_between({0, Offset(lengths.size())}, upper);
  for (const double length : lengths) bonds.kind.push_back({1.0 / length, 1.0});
  return bonds;
}

TEST(ShareOnHorizon, CountsTheBondsOfTheOutermostShell) {
  const Kernel kernel{.horizon = 3.0};
  EXPECT_EQ(share_on_horizon(bonds_of({1.0, 2.0, 3.0 * (1 - 1e-12), 3.0 * (1 + 1e-9)}), kernel),
            0.5);
  EXPECT_EQ(share_on_horizon(bonds_of({1.0, 2.0, 2.985, 2.99}), kernel), 0.0);
  EXPECT_EQ(share_on_horizon(Bonds(), kernel), 0.0);
}

TEST(ShareOnHorizon, IsNoneWhereTheKernelFadesOut) {
  const Bonds bonds = bonds_of({1.0, 3.0});
  for (const auto correction : {VolumeCorrection::linear, VolumeCorrection::exact}) {
    EXPECT_EQ(share_on_horizon(bonds, {.horizon = 3.0, .volume_correction = correction}), 0.0);
  }
  Kernel linear{.horizon = 3.0};
  linear.influence = [](double x) { return 1.0 - x; };
  EXPECT_EQ(share_on_horizon(bonds, linear), 0.0);
  linear.influence = [](double x) { return 2.0 - x; };
  EXPECT_EQ(share_on_horizon(bonds, linear), 0.5);
}

}  // namespace
}  // namespace peristat
