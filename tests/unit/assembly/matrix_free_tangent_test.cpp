#include "assembly/operators/matrix_free_tangent.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent.hpp"
#include "src/potentials/tanh_degradation.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;

BondPotential softening(double micromodulus) {
  return Degraded<TanhDegradation>{micromodulus, TanhDegradation::continuous(0.01, 0.2, 3.0)};
}

TEST(MatrixFreeTangent, IsTheStoredTangent) {
  for (const int dimension : {1, 2, 3}) {
    for (const bool softens : {false, true}) {
      for (const int threads : {1, 2, 3}) {
        for (const double projection : {0.0, 0.25, 1.0}) {
          SCOPED_TRACE(testing::Message() << dimension << "D, softening " << softens << ", threads "
                                          << threads << ", projection " << projection);
          tests::BoxSetting box = tests::small_box(dimension);
          if (softens) box.potential = softening;
          const BoxBody body(box);
          Assembler assembler(body.points, body.model, threads);
          History history = assembler.initial_history();
          if (softens) assembler.commit(body.random_state(1), history);
          const std::vector<double> state = body.random_state(2);
          Tangent stored(BlockPattern(body.model.bonds()), dimension, threads);
          MatrixFreeTangent free(assembler);
          stored.linearise(assembler, {state, history}, projection);
          free.linearise(assembler, {state, history}, projection);
          // Along rows of the lattice the sums have another order.
          EXPECT_LE(tests::distance(free.diagonal, stored.diagonal),
                    1e-14 * tests::norm(stored.diagonal));
          EXPECT_EQ(free.positions(), stored.positions());

          std::vector<double> blocks(stored.off_diagonal.size(), 0.0);
          const std::size_t entries = std::size_t(dimension) * dimension;
          free.for_each_row([&](int, Index i, std::span<const double> row) {
            std::copy(row.begin(), row.end(),
                      blocks.begin() + stored.pattern.offset[i] * std::ptrdiff_t(entries));
          });
          EXPECT_EQ(blocks, stored.off_diagonal);

          const std::vector<double> v = tests::Random(4).vector(body.dofs());
          std::vector<double> by_bonds(v.size()), by_blocks(v.size()), serial(v.size());
          free.multiply(v, by_bonds);
          ASSERT_TRUE(free.multiplies_in_place());
          std::vector<double> in_place = v;
          free.multiply(in_place, in_place);
          EXPECT_EQ(in_place, by_bonds);
          stored.multiply(v, by_blocks);
          EXPECT_LE(tests::distance(by_bonds, by_blocks), 1e-13 * tests::norm(by_blocks));
          Tangent one_thread(BlockPattern(body.model.bonds()), dimension, 1);
          one_thread.linearise(assembler, {state, history}, projection);
          one_thread.multiply(v, serial);
          EXPECT_LE(tests::distance(by_blocks, serial), 1e-14 * tests::norm(serial));

          std::vector<double> sums(v.size()), sums_of_blocks(v.size());
          free.absolute_row_sums(sums);
          stored.absolute_row_sums(sums_of_blocks);
          EXPECT_LE(tests::distance(sums, sums_of_blocks), 1e-14 * tests::norm(sums_of_blocks));
        }
      }
    }
  }
}

TEST(MatrixFreeTangent, RoundsToSinglePrecisionWhereItMay) {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {30, 20, 0};
  const BoxBody body(box);
  Assembler assembler(body.points, body.model, 2);
  const std::vector<double> state = body.random_state(2), v = tests::Random(4).vector(body.dofs());
  MatrixFreeTangent full(assembler), single(assembler, Precision::single);
  full.linearise(assembler, StateView{state}, 0.0);
  single.linearise(assembler, StateView{state}, 0.0);
  EXPECT_FALSE(full.multiplies_in_single());
  EXPECT_TRUE(single.multiplies_in_single());
  std::vector<double> expected(v.size()), rounded(v.size()), result(v.size());
  full.multiply(v, expected);
  single.multiply_in_single(v, rounded);
  EXPECT_LT(tests::distance(rounded, expected), 1e-6 * tests::norm(expected));
  EXPECT_GT(tests::distance(rounded, expected), 1e-9 * tests::norm(expected));
  single.multiply(v, result);
  EXPECT_EQ(result, expected);
  full.multiply_in_single(v, result);
  EXPECT_EQ(result, expected);
}

TEST(MatrixFreeTangent, IsForBondsAlone) {
  tests::BoxSetting box = tests::small_box(2);
  box.triangles = 0.5;
  const BoxBody body(box);
  Assembler assembler(body.points, body.model, 1);
  EXPECT_THROW(MatrixFreeTangent{assembler}, std::logic_error);
}

}  // namespace
}  // namespace peristat
