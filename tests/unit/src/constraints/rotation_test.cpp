#include "src/constraints/rotation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

const Coordinates arm{0.3, -1.1, 0.7};

Coordinates along(const Coordinates& axis, double angle) {
  const double length = std::sqrt(dot<3>(axis, axis));
  return scaled<3>(angle / length, axis);
}

/// Angles on both sides of where the series ends, and beyond a turn.
class Rotations : public testing::TestWithParam<double> {
 protected:
  Coordinates vector = along({1.0, 2.0, -0.5}, GetParam());

  [[nodiscard]] Coordinates shifted(std::size_t k, double by) const {
    Coordinates result = vector;
    result[k] += by;
    return result;
  }
};

TEST_P(Rotations, KeepLengthsAndTheirAxis) {
  const Rotation rotation(vector);
  const Coordinates turned = plus<3>(arm, rotation.moved(arm));
  EXPECT_NEAR(dot<3>(turned, turned), dot<3>(arm, arm), 1e-14);
  EXPECT_NEAR(dot<3>(turned, vector), dot<3>(arm, vector), 1e-14);
  const Coordinates kept = rotation.moved(vector);
  for (const double component : kept) EXPECT_NEAR(component, 0.0, 1e-14);
}

TEST_P(Rotations, HaveTheRatesOfTheirDifferences) {
  const double h = 1e-4;
  const auto rates = Rotation(vector).rates(arm);
  for (std::size_t k = 0; k < 3; ++k) {
    const Coordinates forward = Rotation(shifted(k, h)).moved(arm);
    const Coordinates backward = Rotation(shifted(k, -h)).moved(arm);
    for (std::size_t c = 0; c < 3; ++c) {
      // Third derivatives are of order one: h^2 is left.
      EXPECT_NEAR(rates[k][c], (forward[c] - backward[c]) / (2.0 * h), 2.0 * h * h);
    }
  }
}

TEST_P(Rotations, HaveTheCurvatureOfTheirRates) {
  const Coordinates force{2.0, 0.4, -1.3};
  Tensor moment{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) moment[r][c] = force[r] * arm[c];
  }
  const Tensor curvature = Rotation(vector).curvature(moment);
  const double h = 1e-4;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto forward = Rotation(shifted(k, h)).rates(arm);
    const auto backward = Rotation(shifted(k, -h)).rates(arm);
    for (std::size_t m = 0; m < 3; ++m) {
      const double difference =
          (dot<3>(force, forward[m]) - dot<3>(force, backward[m])) / (2.0 * h);
      EXPECT_NEAR(curvature[m][k], difference, 10.0 * h * h);
      EXPECT_NEAR(curvature[m][k], curvature[k][m], 1e-13);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Angles, Rotations,
                         testing::Values(0.0, 1e-9, 1e-3, 0.3, 0.999999, 1.000001, 2.0, 3.1, 7.0));

TEST(Rotation, AboutZTurnsThePlane) {
  const Coordinates moved = Rotation({0.0, 0.0, 0.5}).moved({1.0, 0.0, 0.0});
  EXPECT_NEAR(moved[0], std::cos(0.5) - 1.0, 1e-16);
  EXPECT_NEAR(moved[1], std::sin(0.5), 1e-16);
}

}  // namespace
}  // namespace peristat
