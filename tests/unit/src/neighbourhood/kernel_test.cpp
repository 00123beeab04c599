#include "src/neighbourhood/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi, delta = 0.3, h = 0.02;

TEST(Kernel, HasTheMomentsOfBalls) {
  EXPECT_DOUBLE_EQ((Kernel{1, delta, h}.moment(0)), 2.0 * delta * h);
  EXPECT_DOUBLE_EQ((Kernel{2, delta, h}.moment(0)), pi * delta * delta * h);
  EXPECT_DOUBLE_EQ((Kernel{3, delta, 1.0}.moment(0)), 4.0 / 3.0 * pi * std::pow(delta, 3));
  EXPECT_DOUBLE_EQ((Kernel{3, delta, 1.0}.moment(2)), 4.0 / 5.0 * pi * std::pow(delta, 5));
}

TEST(Kernel, WeighsMomentsWithItsInfluence) {
  for (const int dimension : {1, 2, 3}) {
    Kernel kernel{dimension, delta, h};
    for (const int k : {0, 1, 2}) {
      kernel.influence = {};
      const double uniform = kernel.moment(k);
      kernel.influence = [](double ratio) { return 1.0 - ratio; };
      // int (1 - t) t^(n-1) over int t^(n-1), n = k + dimension
      EXPECT_NEAR(kernel.moment(k) / uniform, 1.0 / (k + dimension + 1), 1e-14);
      kernel.influence = [](double ratio) { return std::exp(-ratio * ratio); };
      EXPECT_LT(kernel.moment(k), uniform);
      EXPECT_GT(kernel.moment(k), std::exp(-1.0) * uniform);
    }
  }
}

// A volume counts by the share of it within the horizon: a mean of whole balls of the radii around
// the horizon.
TEST(Kernel, HasMomentsOfVolumesThatAreSpreadEvenly) {
  for (const int dimension : {1, 2, 3}) {
    Kernel kernel{dimension, delta, h};
    EXPECT_EQ(kernel.cloud_moment(1, 0.1), kernel.moment(1));
    kernel.volume_correction = VolumeCorrection::linear;
    for (const int k : {0, 1, 2}) {
      const double q = 0.5 * 0.1 / delta, p = k + dimension;
      const double larger = (std::pow(1 + q, p + 1) - std::pow(1 - q, p + 1)) / (2 * q * (p + 1));
      EXPECT_NEAR(kernel.cloud_moment(k, 0.1) / kernel.moment(k), larger, 1e-8);
      EXPECT_NEAR(kernel.cloud_moment(k, 1e-5) / kernel.moment(k), 1.0, 1e-8);
    }
    // Without weight at the horizon, hardly any of the shell counts.
    kernel.influence = [](double ratio) { return std::max(0.0, 1.0 - ratio); };
    EXPECT_NEAR(kernel.cloud_moment(1, 0.01) / kernel.moment(1), 1.0, 1e-3);
  }
}

// Cells that lie across the sphere count by their part: without that the sum over a lattice jumps
// wherever neighbours come in.
TEST(Kernel, HasMomentsOnALatticeThatComeNearThoseOfTheContinuum) {
  for (const int dimension : {1, 2, 3}) {
    Kernel kernel{dimension, delta, h};
    kernel.volume_correction = VolumeCorrection::linear;
    kernel.influence = [](double ratio) { return 1.0 - 0.5 * ratio; };
    for (const int k : {1, 2}) {
      const auto error = [&](double ratio) {
        return std::abs(kernel.lattice_moment(k, delta / ratio) / kernel.moment(k) - 1.0);
      };
      EXPECT_LT(error(3.015), 0.08);
      EXPECT_LT(error(20.0), 2e-3);
    }
  }
}

TEST(Kernel, CountsCellsUpToItsHorizon) {
  Kernel kernel{2, 3.0};
  EXPECT_EQ(kernel.partial_volume(3.0 * (1.0 + 1e-12), 1.0), 1.0);  // at the horizon is inside
  EXPECT_EQ(kernel.partial_volume(3.1, 1.0), 0.0);
  EXPECT_EQ(kernel.search_radius(1.0), 3.0);
  EXPECT_NEAR(kernel.lattice_moment(0, 1.0), 28.0, 1e-12);  // points within 3 of (0, 0), without it
  kernel.volume_correction = VolumeCorrection::linear;
  EXPECT_EQ(kernel.partial_volume(3.0, 1.0), 0.5);
  EXPECT_EQ(kernel.search_radius(1.0), 3.5);
  kernel.volume_correction = VolumeCorrection::exact;
  EXPECT_DOUBLE_EQ(kernel.search_radius(1.0), 3.0 + std::sqrt(0.5));  // half a cell's diagonal
  EXPECT_DOUBLE_EQ(kernel.lattice_moment(0, 1.0), 9.0 * pi - 1.0);  // all but the point's own cell
}

}  // namespace
}  // namespace peristat
