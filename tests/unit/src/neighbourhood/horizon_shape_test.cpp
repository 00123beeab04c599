#include "src/neighbourhood/horizon_shape.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "src/neighbourhood/kernel.hpp"
#include "src/neighbourhood/lattice_kernel.hpp"

namespace peristat {
namespace {

constexpr double delta = 0.3;

double moment(HorizonShape shape, int dimension, int k) {
  Kernel kernel{dimension, delta, 1.0};
  kernel.shape = shape;
  return kernel.moment(k);
}

TEST(HorizonShape, HasTheMomentsOfSquaresAndCubes) {
  const auto shape = HorizonShape::box;
  EXPECT_NEAR(moment(shape, 2, 0), 4.0 * std::pow(delta, 2), 1e-15);
  // The mean distance from the middle of a square of side 1 is (sqrt 2 + arsinh 1) / 6.
  EXPECT_NEAR(moment(shape, 2, 1),
              8.0 * std::pow(delta, 3) * (std::numbers::sqrt2 + std::asinh(1.0)) / 6.0, 1e-15);
  EXPECT_NEAR(moment(shape, 2, 2), 8.0 / 3.0 * std::pow(delta, 4), 1e-15);
  EXPECT_NEAR(moment(shape, 3, 0), 8.0 * std::pow(delta, 3), 1e-15);
  EXPECT_NEAR(moment(shape, 3, 2), 8.0 * std::pow(delta, 5), 1e-15);
}

TEST(HorizonShape, HasTheMomentsOfDiamondsAndOctahedra) {
  const auto shape = HorizonShape::diamond;
  EXPECT_NEAR(moment(shape, 2, 0), 2.0 * std::pow(delta, 2), 1e-15);
  EXPECT_NEAR(moment(shape, 2, 2), 2.0 / 3.0 * std::pow(delta, 4), 1e-15);
  EXPECT_NEAR(moment(shape, 3, 0), 4.0 / 3.0 * std::pow(delta, 3), 1e-15);
  EXPECT_NEAR(moment(shape, 3, 2), 0.4 * std::pow(delta, 5), 1e-15);
}

TEST(HorizonShape, SumsOverLatticesTendToTheMoments) {
  for (const HorizonShape shape : {HorizonShape::box, HorizonShape::diamond}) {
    for (const int dimension : {2, 3}) {
      Kernel kernel{dimension, delta, 1.0};
      kernel.shape = shape;
      kernel.influence = [](double ratio) { return std::max(0.0, 1.0 - ratio); };
      for (const int k : {1, 2}) {
        const auto error = [&](double spacings) {
          return kernel.lattice_moment(k, delta / spacings) / kernel.moment(k) - 1.0;
        };
        EXPECT_LT(std::abs(error(24.0)), 5e-3);
        EXPECT_LT(error(48.0) / error(24.0), 0.3);  // of second order
      }
    }
  }
}

TEST(HorizonShape, CountsNeighbours) {
  const auto neighbours = [](HorizonShape shape, int dimension) {
    Kernel kernel{dimension, 3.0, 1.0};
    kernel.shape = shape;
    int count = 0;
    LatticeKernel(kernel, 1.0).for_each_neighbour([&](const LatticeStep&, double) { ++count; });
    return count;
  };
  EXPECT_EQ(neighbours(HorizonShape::ball, 2), 28);
  EXPECT_EQ(neighbours(HorizonShape::box, 2), 48);
  EXPECT_EQ(neighbours(HorizonShape::diamond, 2), 24);
  EXPECT_EQ(neighbours(HorizonShape::box, 3), 342);
  EXPECT_EQ(neighbours(HorizonShape::diamond, 3), 62);
}

}  // namespace
}  // namespace peristat
