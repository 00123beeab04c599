#include "solvers/linear/cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/linear_systems.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::dense_eigenvalues;
using tests::solution_error;
using tests::some_prescribed;
using tests::System;

TEST(Cholesky, AgreesWithADenseSolve) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    const BoxBody body(box);
    std::vector<double> state = body.random_state(1);
    for (double& entry : state) entry *= 0.1;  // not so far that the tangent is indefinite
    System system(box, some_prescribed(body), state);
    ASSERT_LT(system.free.count(), Index(body.dofs()) - dimension);
    Cholesky solver;
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    EXPECT_GT(solver.estimate().entries, system.free.count());
    ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
    EXPECT_LT(solution_error(system), 1e-11) << dimension << "D";
    ASSERT_TRUE(solver.inertia());
    EXPECT_EQ(solver.inertia()->positive, system.free.count());
    EXPECT_EQ(solver.inertia()->negative, 0);
    EXPECT_EQ(solver.last_iterations(), 0);
    EXPECT_EQ(solver.statistics().factorisations, 1);
  }
}

TEST(Cholesky, ForManySolvesIsAsAccurateAsAskedFor) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    const BoxBody body(box);
    System system(box, some_prescribed(body), std::vector<double>(body.dofs(), 0.0));
    Cholesky solver;
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(solver.factorize(system.tangent, FactorUse::factorize_for_many),
              LinearOutcome::solved);
    ASSERT_EQ(solver.solve(system.b, system.x, 1e-3), LinearOutcome::solved);
    EXPECT_LT(solution_error(system), 1e-4) << dimension << "D";
    EXPECT_GT(solution_error(system), 1e-10) << "not in single precision";
    ASSERT_EQ(solver.solve(system.b, system.x, 1e-12), LinearOutcome::solved);
    EXPECT_LT(solution_error(system), 1e-10);
    // What refinement does not reach the factor in double precision solves.
    ASSERT_EQ(solver.solve(system.b, system.x, 0.0), LinearOutcome::solved);
    EXPECT_LT(solution_error(system), 1e-11);
    EXPECT_EQ(solver.statistics().factorisations, 1);
  }
}

TEST(Cholesky, CountsTheSignsOfAnIndefiniteTangent) {
  for (int dimension = 2; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    const BoxBody body(box);
    std::vector<double> state = body.random_state(2);
    // Compressed to four tenths: a bond's stiffness across, c s / l, is then -1.5 c / L.
    for (std::size_t k = 0; k < state.size(); ++k) {
      state[k] = 0.1 * state[k] - 0.6 * body.points.reference[k];
    }
    System system(box, some_prescribed(body), state);
    const std::vector<double> eigenvalues = dense_eigenvalues(system);
    const auto negative = Index(std::count_if(eigenvalues.begin(), eigenvalues.end(),
                                              [](double value) { return value < 0.0; }));
    ASSERT_GT(negative, 3);
    ASSERT_LT(negative, system.free.count() - 3);
    for (const double value : eigenvalues) ASSERT_GT(std::abs(value), 1e-6 * eigenvalues.back());
    Cholesky solver;
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    EXPECT_EQ(system.solve(solver), LinearOutcome::not_positive_definite);
    ASSERT_TRUE(solver.inertia());
    EXPECT_EQ(solver.inertia()->negative, negative) << dimension << "D";
    EXPECT_EQ(solver.inertia()->positive, system.free.count() - negative);
    EXPECT_EQ(solver.inertia()->zero, 0);

    // The solver is as good as new afterwards.
    system.assemble(std::vector<double>(body.dofs(), 0.0));
    ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
    EXPECT_LT(solution_error(system), 1e-11);
  }
}

/// Solves with a tangent that leaves motions without stiffness.
LinearOutcome outcome_without_support(const tests::BoxSetting& box,
                                      const std::vector<std::size_t>& held) {
  const BoxBody body(box);
  std::vector<char> prescribed(body.dofs(), 0);
  for (std::size_t dof : held) prescribed[dof] = 1;
  System system(box, prescribed, std::vector<double>(body.dofs(), 0.0));
  Cholesky solver;
  EXPECT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  return system.solve(solver);
}

// Whether round-off leaves a zero pivot positive, negative or exactly zero.
TEST(Cholesky, NamesASingularTangent) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    EXPECT_EQ(outcome_without_support(box, {}), LinearOutcome::singular) << dimension << "D, free";
  }
  EXPECT_EQ(outcome_without_support(tests::small_box(2), {10, 11}), LinearOutcome::singular);
  EXPECT_EQ(outcome_without_support(tests::small_box(3), {0, 1, 2, 30, 31, 32}),
            LinearOutcome::singular);
  // A straight row has no stiffness across: its pivots are exactly zero.
  tests::BoxSetting row = tests::small_box(2);
  row.extent = {9, 1, 0};
  EXPECT_EQ(outcome_without_support(row, {0, 1, 16, 17}), LinearOutcome::singular);
}

TEST(Cholesky, RefusesValuesThatAreNotFinite) {
  const tests::BoxSetting box = tests::small_box(2);
  const BoxBody body(box);
  System system(box, some_prescribed(body), std::vector<double>(body.dofs(), 0.0));
  Cholesky solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  system.tangent.diagonal[40] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(system.solve(solver), LinearOutcome::singular);
}

TEST(Cholesky, TakesABodyWithoutFreeDegreesOfFreedom) {
  const tests::BoxSetting box = tests::small_box(2);
  const BoxBody body(box);
  System system(box, std::vector<char>(body.dofs(), 1), std::vector<double>(body.dofs(), 0.0));
  Cholesky solver;
  EXPECT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  EXPECT_EQ(system.solve(solver), LinearOutcome::solved);
  EXPECT_EQ(solver.statistics().factorisations, 0);
}

/// Large enough that some iterations cost less than a factorisation: affordable_iterations.
System large_system() {
  tests::BoxSetting box = tests::small_box(3);
  box.extent = {14, 13, 12};
  const BoxBody body(box);
  return System(box, some_prescribed(body), std::vector<double>(body.dofs(), 0.0));
}

TEST(Cholesky, ReusedFactorGivesTheSolutionOfTheNewTangent) {
  System system = large_system();
  Cholesky reusing, fresh(FactorReuse{0, 1e-12});
  for (Cholesky* solver : {&reusing, &fresh}) {
    ASSERT_EQ(solver->analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(system.solve(*solver), LinearOutcome::solved);
  }
  const std::vector<double> old_solution = system.x;

  std::vector<double> state = system.body.random_state(5);
  for (double& entry : state) entry *= 1e-4;
  system.assemble(state);
  ASSERT_EQ(system.solve(fresh, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(fresh.statistics().factorisations, 2);
  const std::vector<double> expected = system.x;
  ASSERT_GT(tests::distance(old_solution, expected), 1e-7 * tests::norm(expected));

  ASSERT_EQ(system.solve(reusing, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(reusing.statistics().factorisations, 1);
  EXPECT_GT(reusing.last_iterations(), 0);
  EXPECT_EQ(reusing.statistics().iterations, reusing.last_iterations());
  EXPECT_LT(tests::distance(system.x, expected), 1e-10 * tests::norm(expected));

  ASSERT_EQ(system.solve(reusing, FactorUse::factorize_now), LinearOutcome::solved);
  EXPECT_EQ(reusing.statistics().factorisations, 2);
  EXPECT_EQ(reusing.last_iterations(), 0);
}

TEST(Cholesky, FactorizesAnewWhereTheOldFactorIsTooFarAway) {
  System system = large_system();
  Cholesky solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  ASSERT_EQ(system.solve(solver), LinearOutcome::solved);

  std::vector<double> state = system.body.random_state(5);
  for (std::size_t k = 0; k < state.size(); ++k) state[k] += system.body.points.reference[k];
  system.assemble(state);  // twice as long, and uneven
  ASSERT_EQ(system.solve(solver, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(solver.statistics().factorisations, 2);
  EXPECT_EQ(solver.last_iterations(), 0);
  std::vector<double> product(system.body.dofs()), full(system.body.dofs()), rest(system.b);
  system.free.extend_by_zero(system.x, full);
  system.tangent.multiply(full, product);
  system.free.restrict_to_free(product, rest);
  EXPECT_LT(tests::distance(rest, system.b), 1e-10 * tests::norm(system.b));

  // And an indefinite one is seen as such, although an old factor could stand in.
  for (std::size_t k = 0; k < state.size(); ++k) state[k] = -0.6 * system.body.points.reference[k];
  system.assemble(state);
  EXPECT_EQ(system.solve(solver, FactorUse::may_reuse), LinearOutcome::not_positive_definite);
  ASSERT_TRUE(solver.inertia());
  EXPECT_GT(solver.inertia()->negative, 0);
}

TEST(Cholesky, DescribesItself) {
  System system = large_system();
  Cholesky solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  EXPECT_NE(solver.describe().find("CHOLMOD"), std::string::npos);
  EXPECT_NE(solver.describe().find(solver.estimate().ordering), std::string::npos);
  EXPECT_GT(solver.estimate().flops, solver.estimate().entries);
}

TEST(Cholesky, RefusesAFactorThatIsTooLarge) {
  const tests::BoxSetting box = tests::small_box(2);
  const BoxBody body(box);
  System system(box, some_prescribed(body), std::vector<double>(body.dofs(), 0.0));
  Cholesky unlimited;
  ASSERT_EQ(unlimited.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  const double bytes = unlimited.estimate().bytes();
  Cholesky enough(FactorReuse{}, bytes), too_little(FactorReuse{}, bytes - 1.0);
  EXPECT_EQ(enough.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  EXPECT_EQ(too_little.analyze(system.tangent.pattern, system.free), LinearOutcome::out_of_memory);
}

}  // namespace
}  // namespace peristat
