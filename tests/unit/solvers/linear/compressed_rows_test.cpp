#include "solvers/linear/compressed_rows.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

struct Assembled {
  tests::BoxBody body;
  Tangent tangent;

  explicit Assembled(int dimension, bool at_rest)
      : body(tests::small_box(dimension)), tangent(Assembler(body.points, body.model, 1)) {
    const std::vector<double> rest(body.dofs(), 0.0);
    Assembler(body.points, body.model, 1).tangent(at_rest ? rest : body.random_state(4), tangent);
  }
};

std::vector<double> product(const CompressedRows& matrix, const double* v) {
  std::vector<double> result(std::size_t(matrix.rows), 0.0);
  for (int row = 0; row < matrix.rows; ++row) {
    for (std::size_t k = matrix.begin[row]; k < matrix.begin[row + 1]; ++k) {
      result[row] += matrix.value[k] * v[matrix.column[k]];
    }
  }
  return result;
}

class CompressedRowsOf : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Dimensions, CompressedRowsOf, testing::Values(1, 2, 3));

TEST_P(CompressedRowsOf, MultiplyLikeTheTangent) {
  const int d = GetParam();
  const Assembled assembled(d, false);
  std::vector<char> prescribed(assembled.body.dofs(), 0);
  for (std::size_t dof = 0; dof < prescribed.size(); dof += 5) prescribed[dof] = 1;
  const FreeDofs free(prescribed, d);
  const CompressedRows matrix = compressed_rows(assembled.tangent, free);
  ASSERT_EQ(matrix.rows, free.count());
  ASSERT_GT(matrix.rows, 10);

  const std::vector<double> v = tests::Random(1).vector(std::size_t(free.count()));
  std::vector<double> full(assembled.body.dofs()), image(full.size()), expected(v.size());
  free.extend_by_zero(v, full);
  assembled.tangent.multiply(full, image);
  free.restrict_to_free(image, expected);
  // Round-off of some 400 terms of a row.
  EXPECT_LT(tests::distance(product(matrix, v.data()), expected), 1e-14 * tests::norm(expected));
}

TEST_P(CompressedRowsOf, HaveAscendingColumnsWithTheDiagonalAmongThem) {
  const int d = GetParam();
  const Assembled assembled(d, false);
  const FreeDofs free(std::vector<char>(assembled.body.dofs(), 0), d);
  const CompressedRows matrix = compressed_rows(assembled.tangent, free);
  ASSERT_EQ(matrix.begin.size(), std::size_t(matrix.rows) + 1);
  EXPECT_EQ(matrix.begin.back(), matrix.value.size());
  EXPECT_EQ(matrix.column.size(), matrix.value.size());
  for (int row = 0; row < matrix.rows; ++row) {
    const auto first = matrix.column.begin() + std::ptrdiff_t(matrix.begin[row]);
    const auto last = matrix.column.begin() + std::ptrdiff_t(matrix.begin[row + 1]);
    EXPECT_TRUE(std::is_sorted(first, last));
    EXPECT_EQ(std::count(first, last, row), 1);
  }
}

TEST_P(CompressedRowsOf, TakeRigidMotionsOfABodyAtRestToZero) {
  const int d = GetParam();
  const Assembled assembled(d, true);
  const FreeDofs free(std::vector<char>(assembled.body.dofs(), 0), d);
  const CompressedRows matrix = compressed_rows(assembled.tangent, free);
  const NearNullSpace motions = rigid_motions(assembled.body.points.reference, free);
  ASSERT_EQ(motions.count, d * (d + 1) / 2);
  ASSERT_EQ(motions.values.size(), std::size_t(motions.count) * free.dof.size());
  const double scale = assembled.tangent.frobenius_norm();
  for (int motion = 0; motion < motions.count; ++motion) {
    const double* v = motions.values.data() + std::size_t(motion) * free.dof.size();
    const std::vector<double> moved(v, v + free.dof.size());
    EXPECT_GT(tests::norm(moved), 0.1);
    EXPECT_LT(tests::largest(moved), 1.0 + 1e-12);
    EXPECT_LT(tests::norm(product(matrix, v)), 1e-14 * scale * tests::norm(moved));
  }
}

TEST(RigidMotions, AreThoseOfTheFreeDofs) {
  // Two points at (0, 0) and (2, 0): the rotation about their centre lifts the right one.
  const std::vector<double> positions{0.0, 0.0, 2.0, 0.0};
  const NearNullSpace motions = rigid_motions(positions, FreeDofs({0, 1, 0, 0}, 2));
  ASSERT_EQ(motions.count, 3);
  EXPECT_EQ(motions.values, (std::vector<double>{1, 1, 0, 0, 0, 1, 0, 0, 1}));
}

TEST(EquationBlocks, SayWhatIsPrescribed) {
  const EquationBlocks blocks = equation_blocks(FreeDofs({0, 1, 0, 0}, 2));
  EXPECT_EQ(blocks.size, 2);
  EXPECT_EQ(blocks.dof, (std::vector<int>{0, 2, 3}));
}

}  // namespace
}  // namespace peristat
