#include "solvers/linear/local_operator.hpp"

#include <memory>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "tests/unsymmetric_operator.hpp"

namespace peristat {
namespace {

using tests::GridSetting;
using tests::GridSystem;

GridSetting grid(int dimension, int side, double reach) {
  GridSetting of;
  of.dimension = dimension;
  of.side = side;
  of.reach = reach;
  return of;
}

IterativeSolver with_local_operator(KrylovMethod method, int restart = 200) {
  return {method, std::make_unique<LocalOperator>(), 1000, restart};
}

LinearOutcome analyze_and_solve(GridSystem& system, LinearSolver& solver, double tolerance) {
  const LinearOutcome outcome = solver.analyze(system.tangent.pattern, system.free);
  return outcome == LinearOutcome::solved ? system.solve(solver, tolerance) : outcome;
}

TEST(LocalOperator, IsTheInverseOfANeighbourlyTangent) {
  // Its reach is that of the stand-in.
  for (const int dimension : {2, 3}) {
    GridSystem system(grid(dimension, 9, 1.5));
    IterativeSolver solver = with_local_operator(KrylovMethod::gmres);
    ASSERT_EQ(analyze_and_solve(system, solver, 1e-10), LinearOutcome::solved);
    EXPECT_EQ(solver.last_iterations(), 1);
    EXPECT_LT(system.error(), 1e-9);
  }
}

TEST(LocalOperator, KeepsTheIterationsOfGmresFewWhateverTheSize) {
  std::vector<int> iterations;
  for (const int side : {12, 40}) {
    GridSystem system(grid(2, side, 3.01));
    IterativeSolver solver = with_local_operator(KrylovMethod::gmres);
    ASSERT_EQ(analyze_and_solve(system, solver, 1e-10), LinearOutcome::solved);
    EXPECT_LT(system.error(), 1e-7);
    EXPECT_EQ(solver.statistics().factorisations, 1);
    EXPECT_EQ(solver.statistics().iterations, solver.last_iterations());
    iterations.push_back(solver.last_iterations());
    IterativeSolver jacobi(KrylovMethod::gmres,
                           std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points), 1000, 200);
    ASSERT_EQ(analyze_and_solve(system, jacobi, 1e-10), LinearOutcome::solved);
    EXPECT_LT(system.error(), 1e-7);
    EXPECT_GT(jacobi.last_iterations(), 2 * iterations.back());
  }
  EXPECT_LE(iterations[1], iterations[0] + 4);
}

TEST(LocalOperator, ServesBicgstabToo) {
  for (const int dimension : {1, 2, 3}) {
    GridSystem system(grid(dimension, dimension == 3 ? 9 : 30, 2.5));
    IterativeSolver solver = with_local_operator(KrylovMethod::bicgstab);
    ASSERT_EQ(analyze_and_solve(system, solver, 1e-10), LinearOutcome::solved);
    EXPECT_LE(system.residual(), 1e-10);
    EXPECT_LT(system.error(), 1e-5);  // in 1D ten thousand times the residual
    EXPECT_GT(solver.last_iterations(), 1);
    EXPECT_EQ(solver.describe(), "BiCGStab preconditioned by local operator");
  }
}

TEST(LocalOperator, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (const KrylovMethod method : {KrylovMethod::gmres, KrylovMethod::bicgstab}) {
    std::vector<std::vector<double>> found;
    for (const int threads : {1, 3}) {
      GridSetting of = grid(2, 20, 3.01);
      of.threads = threads;
      GridSystem system(of);
      IterativeSolver solver = with_local_operator(method);
      ASSERT_EQ(analyze_and_solve(system, solver, 1e-10), LinearOutcome::solved);
      found.push_back(system.x);
    }
    EXPECT_EQ(found[0], found[1]);
  }
}

TEST(LocalOperator, ServesTheNextTangents) {
  GridSystem system(grid(2, 24, 3.01));
  IterativeSolver solver = with_local_operator(KrylovMethod::gmres);
  ASSERT_EQ(analyze_and_solve(system, solver, 1e-10), LinearOutcome::solved);
  const int before = solver.last_iterations();
  system.tangent.setting.disorder = 0.25;
  system.tangent.assemble();
  system.find_right_hand_side();
  ASSERT_EQ(system.solve(solver, 1e-10, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_LT(system.error(), 1e-7);
  EXPECT_EQ(solver.statistics().factorisations, 1);
  EXPECT_LT(solver.last_iterations(), 1.4 * before);
}

TEST(LocalOperator, OfASingularStandInIsThePreconditionersFailure) {
  GridSystem loose(grid(2, 8, 2.5), false);
  LocalOperator preconditioner;
  preconditioner.analyze(loose.tangent.pattern, loose.free);
  EXPECT_EQ(preconditioner.build(loose.tangent), LinearOutcome::inaccurate);
  // No solution is told where there is none: translations are free, and the load moves them.
  loose.b.assign(loose.b.size(), 1.0);
  IterativeSolver solver(KrylovMethod::gmres,
                         std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points), 300, 200);
  EXPECT_EQ(analyze_and_solve(loose, solver, 1e-10), LinearOutcome::inaccurate);
}

TEST(LocalOperator, TakesNoMoreMemoryThanItMay) {
  GridSystem system(grid(2, 24, 3.01));
  LocalOperator preconditioner(1e4);
  preconditioner.analyze(system.tangent.pattern, system.free);
  EXPECT_EQ(preconditioner.build(system.tangent), LinearOutcome::out_of_memory);
}

TEST(LocalOperator, IsForUnsymmetricTangents) {
  const tests::BoxBody body(tests::small_box(2));
  const Tangent tangent{BlockPattern(body.model.bonds()), 2};
  const FreeDofs free(std::vector<char>(body.dofs(), 0), 2);
  LocalOperator preconditioner;
  preconditioner.analyze(tangent.pattern, free);
  EXPECT_THROW(static_cast<void>(preconditioner.build(tangent)), std::logic_error);
}

TEST(Bicgstab, TakesAFewIterationsWhereMassDominates) {
  GridSetting of = grid(2, 40, 3.01);
  of.mass = 300.0;  // over row sums of some 30
  GridSystem system(of);
  IterativeSolver solver(KrylovMethod::bicgstab,
                         std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points), 100);
  ASSERT_EQ(analyze_and_solve(system, solver, 1e-10), LinearOutcome::solved);
  EXPECT_LE(solver.last_iterations(), 6);
  EXPECT_LT(system.error(), 1e-9);
}

TEST(BlockJacobi, OfAnUnsymmetricTangentSaysNothingAboutIt) {
  // A diagonal that vanishes: the tangent may be as good as any.
  GridSystem system(grid(2, 8, 2.5));
  std::fill(system.tangent.diagonal.begin(), system.tangent.diagonal.end(), 0.0);
  for (const auto blocks : {BlockJacobi::Blocks::points, BlockJacobi::Blocks::entries}) {
    IterativeSolver solver(KrylovMethod::gmres, std::make_unique<BlockJacobi>(blocks), 100);
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    EXPECT_EQ(system.solve(solver), LinearOutcome::inaccurate);
  }
}

TEST(GmresOfBelos, GoesOnAfterARestart) {
  GridSystem system(grid(2, 32, 3.01));
  IterativeSolver patient = with_local_operator(KrylovMethod::gmres, 200);
  IterativeSolver short_of_memory = with_local_operator(KrylovMethod::gmres, 8);
  ASSERT_EQ(analyze_and_solve(system, patient, 1e-10), LinearOutcome::solved);
  ASSERT_EQ(analyze_and_solve(system, short_of_memory, 1e-10), LinearOutcome::solved);
  EXPECT_LT(system.error(), 1e-7);
  EXPECT_GT(short_of_memory.last_iterations(), patient.last_iterations());
}

}  // namespace
}  // namespace peristat
