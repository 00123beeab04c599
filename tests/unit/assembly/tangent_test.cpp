#include "assembly/operators/tangent.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

/// Three points in a row, bonds 0-1 and 1-2, with numbers that tell their place.
struct Example {
  Bonds bonds = tests::bonds_between({0, 1, 2, 2}, {1, 2});
  Tangent tangent{BlockPattern(bonds), 2};

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

TEST(Tangent, StartsAtZero) {
  const tests::BoxBody body(tests::small_box(3));
  const Tangent tangent(BlockPattern(body.model.bonds()), 3);
  EXPECT_EQ(tangent.diagonal.size(), body.points.volume.size() * 9);
  EXPECT_EQ(tangent.off_diagonal.size(), std::size_t(body.model.bonds().count()) * 9);
  EXPECT_EQ(tangent.frobenius_norm(), 0.0);
}

TEST(Tangent, OfBondsIsStoredByUpperHalves) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    SCOPED_TRACE(::testing::Message() << dimension << "D");
    const tests::BoxBody body(tests::small_box(dimension));
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(7);
    Tangent halves(assembler), whole(BlockPattern(body.model.bonds()), dimension, 2);
    ASSERT_EQ(halves.blocks, Tangent::Blocks::upper_halves);
    ASSERT_EQ(whole.blocks, Tangent::Blocks::whole);
    assembler.tangent(state, halves);
    assembler.tangent(state, whole);
    EXPECT_EQ(halves.off_diagonal.size(),
              std::size_t(body.model.bonds().count()) * dimension * (dimension + 1) / 2);
    EXPECT_EQ(halves.diagonal, whole.diagonal);
    EXPECT_GT(whole.frobenius_norm(), 0.0);
    EXPECT_EQ(halves.frobenius_norm(), whole.frobenius_norm());
    for (Offset bond = 0; bond < body.model.bonds().count(); ++bond) {
      for (int r = 0; r < dimension; ++r) {
        for (int c = 0; c < dimension; ++c) {
          ASSERT_EQ(halves.entry(bond, r, c), whole.entry(bond, r, c));
          ASSERT_EQ(halves.entry(bond, r, c), halves.entry(bond, c, r));
        }
      }
    }
    const std::vector<double> v = tests::Random(5).vector(body.dofs());
    std::vector<double> of_halves(v.size()), of_whole(v.size());
    halves.multiply(v, of_halves);
    whole.multiply(v, of_whole);
    EXPECT_LE(tests::distance(of_halves, of_whole), 1e-14 * tests::norm(of_whole));
    std::vector<double> blocks(whole.off_diagonal.size(), 0.0);
    halves.for_each_row([&](int, Index i, std::span<const double> row) {
      std::copy(row.begin(), row.end(),
                blocks.begin() + body.model.bonds().offset[i] * dimension * dimension);
    });
    EXPECT_EQ(blocks, whole.off_diagonal);
  }
}

TEST(Tangent, OfTrianglesAndTetrahedraIsStoredByWholeBlocks) {
  tests::BoxSetting box = tests::small_box(3);
  box.triangles = box.tetrahedra = 1.0;
  const tests::BoxBody body(box);
  Assembler assembler(body.points, body.model, 1);
  EXPECT_EQ(Tangent(assembler).blocks, Tangent::Blocks::whole);
  Tangent halves(BlockPattern(body.model.bonds()), 3, 1, Tangent::Blocks::upper_halves);
  EXPECT_THROW(assembler.tangent(body.random_state(7), halves), std::logic_error);
}

}  // namespace
}  // namespace peristat
