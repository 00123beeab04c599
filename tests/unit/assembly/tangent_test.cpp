#include "assembly/tangent.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

/// Three points in a row, bonds 0-1 and 1-2, with numbers that tell their place.
struct Example {
  Bonds bonds{{0, 1, 2, 2}, {1, 2}, {}};
  Tangent tangent{Pattern(bonds), 2};

  Example() {
    tangent.diagonal = {1, 2, 2, 3, 4, 5, 5, 6, 7, 8, 8, 9};
    tangent.off_diagonal = {10, 11, 12, 13, 20, 21, 22, 23};
  }
};

constexpr double dense[6][6] = {{1, 2, 10, 11, 0, 0},   {2, 3, 12, 13, 0, 0},
                                {10, 12, 4, 5, 20, 21}, {11, 13, 5, 6, 22, 23},
                                {0, 0, 20, 22, 7, 8},   {0, 0, 21, 23, 8, 9}};

TEST(Tangent, MultipliesWithBothHalves) {
  const Example example;
  EXPECT_EQ(example.tangent.dofs(), 6);
  for (int column = 0; column < 6; ++column) {
    std::vector<double> unit(6, 0.0), result(6, 1e300);
    unit[column] = 1.0;
    example.tangent.multiply(unit, result);
    for (int row = 0; row < 6; ++row) EXPECT_EQ(result[row], dense[row][column]);
  }
}

TEST(Tangent, FrobeniusNormCountsBothHalves) {
  double squared = 0.0;
  for (const auto& row : dense) {
    for (double entry : row) squared += entry * entry;
  }
  EXPECT_DOUBLE_EQ(Example().tangent.frobenius_norm(), std::sqrt(squared));
}

TEST(Tangent, AsymmetryIsRelativeToTheLargestEntry) {
  Example example;
  EXPECT_EQ(example.tangent.asymmetry(), 0.0);
  example.tangent.diagonal[5] += 0.5;
  EXPECT_DOUBLE_EQ(example.tangent.asymmetry(), 0.5 / 23.0);
}

TEST(Tangent, StartsAtZero) {
  const tests::BoxBody body(tests::small_box(3));
  const Tangent tangent(Pattern(body.model.bonds), 3);
  EXPECT_EQ(tangent.diagonal.size(), body.points.volume.size() * 9);
  EXPECT_EQ(tangent.off_diagonal.size(), std::size_t(body.model.bonds.count()) * 9);
  EXPECT_EQ(tangent.frobenius_norm(), 0.0);
}

}  // namespace
}  // namespace peristat
