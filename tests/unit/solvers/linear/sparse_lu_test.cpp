#include "solvers/linear/sparse_lu.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <gtest/gtest.h>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/free_rows.hpp"
#include "tests/unsymmetric_operator.hpp"

namespace peristat {
namespace {

using tests::GridOperator;
using tests::GridSetting;
using tests::GridSystem;

GridSetting grid(int dimension, int side, double reach) {
  GridSetting of;
  of.dimension = dimension;
  of.side = side;
  of.reach = reach;
  return of;
}

/// K_ff from the rows of K, put together independently.
Eigen::SparseMatrix<double> eigen_matrix(const GridSystem& system) {
  const SparseRows all = system.tangent.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index row = 0; row < all.rows(); ++row) {
    for (Offset k = all.offset[std::size_t(row)]; k < all.offset[std::size_t(row) + 1]; ++k) {
      const Index r = system.free.equation[std::size_t(row)];
      const Index c = system.free.equation[std::size_t(all.column[std::size_t(k)])];
      if (r >= 0 && c >= 0) entries.emplace_back(r, c, all.value[std::size_t(k)]);
    }
  }
  Eigen::SparseMatrix<double> matrix(system.free.count(), system.free.count());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(FreeRows, AreThoseOfTheEquations) {
  const GridSystem system(grid(2, 9, 2.5));
  const SparseRows rows = free_rows(system.tangent.rows(), system.free);
  const Eigen::SparseMatrix<double> expected = eigen_matrix(system);
  ASSERT_EQ(rows.rows(), system.free.count());
  EXPECT_EQ(rows.column.size(), std::size_t(expected.nonZeros()));
  for (Index r = 0; r < rows.rows(); ++r) {
    Index last = -1;
    for (Offset k = rows.offset[std::size_t(r)]; k < rows.offset[std::size_t(r) + 1]; ++k) {
      const Index c = rows.column[std::size_t(k)];
      EXPECT_GT(c, last);
      last = c;
      EXPECT_EQ(rows.value[std::size_t(k)], expected.coeff(r, c));
    }
  }
  EXPECT_THROW(static_cast<void>(free_rows({{0, 0}, {}, {}}, system.free)), std::logic_error);
}

TEST(UnsymmetricTangent, SumsItsRowsAndHasNoBlocks) {
  const GridOperator tangent(grid(2, 6, 2.0));
  const GridSystem system(grid(2, 6, 2.0), false);
  std::vector<double> sums(std::size_t(tangent.dofs()), -1.0);
  tangent.absolute_row_sums(sums);
  const Eigen::MatrixXd dense(eigen_matrix(system));
  for (std::size_t r = 0; r < sums.size(); ++r) {
    EXPECT_NEAR(sums[r], dense.row(Eigen::Index(r)).cwiseAbs().sum(), 1e-13);
  }
  EXPECT_GT((dense - dense.transpose()).norm(), 0.1 * dense.norm());
  EXPECT_THROW(tangent.for_each_row([](int, Index, std::span<const double>) {}), std::logic_error);
}

TEST(SparseLu, AgreesWithEigen) {
  for (const auto& setting : {grid(1, 300, 6.0), grid(2, 30, 3.01), grid(3, 9, 2.1)}) {
    SCOPED_TRACE(std::to_string(setting.dimension) + "D");
    GridSystem system(setting);
    Eigen::SparseMatrix<double> matrix = eigen_matrix(system);
    ASSERT_GT((Eigen::MatrixXd(matrix) - Eigen::MatrixXd(matrix).transpose()).norm(), 1.0);
    // Another right-hand side than that of the known solution.
    system.b = tests::Random(8).vector(system.b.size());
    SparseLu solver;
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(matrix);
    const auto size = Eigen::Index(system.b.size());
    const Eigen::VectorXd expected =
        factor.solve(Eigen::Map<const Eigen::VectorXd>(system.b.data(), size));
    const Eigen::Map<const Eigen::VectorXd> found(system.x.data(), size);
    EXPECT_LT((found - expected).norm(), 1e-11 * expected.norm());
    EXPECT_EQ(solver.last_iterations(), 0);
    EXPECT_FALSE(solver.inertia());
  }
}

TEST(SparseLu, SolvesAHundredThousandEquations) {
  GridSystem system(grid(2, 225, 1.5));
  ASSERT_GT(system.free.count(), 97'000);
  SparseLu solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
  EXPECT_LT(system.error(), 1e-10);
  EXPECT_NE(solver.describe().find("METIS"), std::string::npos);
}

TEST(SparseLu, FindsItsOrderOncePerPatternAndFactorisesWhatHasChanged) {
  GridSystem system(grid(2, 20, 2.5));
  SparseLu solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  const auto expect_solved = [&](int orders, int factorisations) {
    system.find_right_hand_side();
    ASSERT_EQ(system.solve(solver, 1e-12, FactorUse::may_reuse), LinearOutcome::solved);
    EXPECT_LT(system.error(), 1e-11);
    EXPECT_EQ(solver.factor().orders(), orders);
    EXPECT_EQ(solver.statistics().factorisations, factorisations);
  };
  expect_solved(1, 1);
  expect_solved(1, 1);  // the same tangent
  system.tangent.setting.seed = 2;
  system.tangent.assemble();
  expect_solved(1, 2);
  system.tangent.matrix.value.back() *= 1.5;  // the least that can change
  expect_solved(1, 3);
  system.tangent.setting.reach = 3.01;
  system.tangent.assemble();
  expect_solved(2, 4);
  // Others are free: as many entries, at other places.
  std::vector<char> prescribed(std::size_t(system.tangent.dofs()), 0);
  std::fill_n(prescribed.end() - 40, 40, 1);
  system.free = FreeDofs(prescribed, 2);
  system.expected = tests::Random(4).vector(std::size_t(system.free.count()));
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  expect_solved(3, 5);
}

TEST(SparseLu, GivesTheSameBitsOnAnyNumberOfThreads) {
  std::vector<std::vector<double>> found;
  for (const int threads : {1, 2, 3}) {
    GridSetting of = grid(3, 10, 2.1);
    of.threads = threads;
    GridSystem system(of);
    SparseLu solver;
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
    found.push_back(system.x);
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

TEST(SparseLu, BearsAVanishingDiagonal) {
  // Rows in another order: a system that is as good, with a diagonal that tells nothing.
  GridSystem system(grid(2, 12, 1.5));
  SparseRows rows = free_rows(system.tangent.rows(), system.free);
  const Eigen::SparseMatrix<double> matrix = eigen_matrix(system);
  SparseRows turned{{0}, {}, {}};
  for (Index r = 0; r < rows.rows(); ++r) {
    const auto from = std::size_t((r + 40) % rows.rows());
    for (auto k = std::size_t(rows.offset[from]); k < std::size_t(rows.offset[from + 1]); ++k) {
      turned.column.push_back(rows.column[k]);
      turned.value.push_back(rows.value[k]);
    }
    turned.offset.push_back(Offset(turned.column.size()));
  }
  LuFactor factor;
  ASSERT_EQ(factor.factorize(turned), LinearOutcome::solved);
  std::vector<double> v(system.b.size());
  for (std::size_t r = 0; r < v.size(); ++r) v[r] = system.b[(r + 40) % v.size()];
  factor.solve(v);
  EXPECT_LT(tests::distance(v, system.expected), 1e-10 * tests::norm(system.expected));
}

TEST(SparseLu, NamesWhatIsSingular) {
  // Not held: translations cost nothing. The last pivots of the large ones are far from zero.
  for (const auto& setting :
       {grid(1, 300, 6.0), grid(2, 8, 2.5), grid(2, 80, 1.5), grid(3, 9, 2.1)}) {
    GridSystem loose(setting, false);
    SparseLu solver;
    ASSERT_EQ(solver.analyze(loose.tangent.pattern, loose.free), LinearOutcome::solved);
    EXPECT_EQ(loose.solve(solver), LinearOutcome::singular);
    EXPECT_EQ(solver.solve(loose.b, loose.x, 1e-8), LinearOutcome::singular);
    // A mass holds them, however light.
    loose.tangent.setting.mass = 1e-6;
    loose.tangent.assemble();
    loose.find_right_hand_side();
    EXPECT_EQ(loose.solve(solver), LinearOutcome::solved);
    EXPECT_LT(loose.error(), 1e-6);
  }
  // Stiffnesses that differ by twelve orders are no reason.
  GridSystem mixed(grid(2, 12, 2.5));
  SparseRows& unequal = mixed.tangent.matrix;
  for (auto k = std::size_t(unequal.offset[100]); k < unequal.value.size(); ++k) {
    unequal.value[k] *= 1e12;
  }
  mixed.find_right_hand_side();
  SparseLu of_both;
  ASSERT_EQ(of_both.analyze(mixed.tangent.pattern, mixed.free), LinearOutcome::solved);
  EXPECT_EQ(mixed.solve(of_both), LinearOutcome::solved);
  EXPECT_LT(mixed.error(), 1e-3);
  // A row of zeros; and one that has no entry.
  GridSystem system(grid(2, 8, 2.5));
  SparseLu solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  SparseRows& rows = system.tangent.matrix;
  std::fill(rows.value.begin() + rows.offset[70], rows.value.begin() + rows.offset[71], 0.0);
  EXPECT_EQ(system.solve(solver), LinearOutcome::singular);
  rows.column.erase(rows.column.begin() + rows.offset[70], rows.column.begin() + rows.offset[71]);
  rows.value.erase(rows.value.begin() + rows.offset[70], rows.value.begin() + rows.offset[71]);
  const Offset gone = rows.offset[71] - rows.offset[70];
  for (std::size_t r = 71; r < rows.offset.size(); ++r) rows.offset[r] -= gone;
  EXPECT_EQ(system.solve(solver), LinearOutcome::singular);
}

TEST(SparseLu, RefusesValuesThatAreNotFinite) {
  GridSystem system(grid(2, 8, 2.5));
  SparseLu solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    system.tangent.matrix.value.back() = wrong;
    EXPECT_EQ(system.solve(solver), LinearOutcome::singular);
  }
}

TEST(SparseLu, JudgesByTheOperatorItself) {
  // Rows that are not the operator's: refinement makes up for little, and nothing for much.
  struct Astray : GridOperator {
    using GridOperator::GridOperator;
    double wrong = 0.0;
    [[nodiscard]] SparseRows rows() const override {
      SparseRows made = matrix;
      for (double& value : made.value) value *= 1.0 + wrong;
      return made;
    }
  };
  const GridSystem system(grid(2, 12, 2.5));
  Astray tangent(system.tangent.setting);
  for (const auto& [wrong, expected] :
       {std::pair{1e-3, LinearOutcome::solved}, std::pair{0.1, LinearOutcome::inaccurate}}) {
    tangent.wrong = wrong;
    SparseLu solver;
    ASSERT_EQ(solver.analyze(tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
    std::vector<double> x(system.b.size());
    EXPECT_EQ(solver.solve(system.b, x, 1e-10), expected);
    EXPECT_EQ(tests::distance(x, system.expected) < 1e-7 * tests::norm(system.expected),
              expected == LinearOutcome::solved);
  }
}

TEST(SparseLu, TakesNoMoreMemoryThanItMay) {
  GridSystem system(grid(2, 30, 3.01));
  const double rows = system.tangent.bytes_of_rows();
  // Neither the rows fit; nor the factor; then both.
  for (const auto& [bytes, expected] : {std::pair{0.9 * rows, LinearOutcome::out_of_memory},
                                        std::pair{2.5 * rows, LinearOutcome::out_of_memory},
                                        std::pair{50.0 * rows, LinearOutcome::solved}}) {
    SparseLu solver(bytes);
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    EXPECT_EQ(system.solve(solver), expected);
    EXPECT_EQ(solver.statistics().factorisations, expected == LinearOutcome::solved ? 1 : 0);
    EXPECT_EQ(solver.factor().is_ready(), expected == LinearOutcome::solved);
  }
}

TEST(SparseLu, TakesABodyWithoutFreeDegreesOfFreedom) {
  const GridOperator tangent(grid(2, 4, 1.5));
  const FreeDofs free(std::vector<char>(std::size_t(tangent.dofs()), 1), 2);
  SparseLu solver;
  EXPECT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
  EXPECT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
  EXPECT_EQ(solver.solve({}, {}, 1e-10), LinearOutcome::solved);
}

TEST(SparseLu, IsForUnsymmetricTangents) {
  const tests::BoxBody body(tests::small_box(2));
  const Tangent tangent{BlockPattern(body.model.bonds()), 2};
  const FreeDofs free(std::vector<char>(body.dofs(), 0), 2);
  EXPECT_FALSE(tangent.as_unsymmetric());
  SparseLu solver;
  ASSERT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
  EXPECT_THROW(static_cast<void>(solver.factorize(tangent, FactorUse::factorize_now)),
               std::logic_error);
}

}  // namespace
}  // namespace peristat
