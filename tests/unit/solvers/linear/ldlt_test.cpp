#include "solvers/linear/ldlt.hpp"

#include <algorithm>
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

/// A body in a random state, compressed to a share of its size.
System compressed_system(int dimension, double share) {
  const tests::BoxSetting box = tests::small_box(dimension);
  const BoxBody body(box);
  std::vector<double> state = body.random_state(2);
  for (std::size_t k = 0; k < state.size(); ++k) {
    state[k] = 0.1 * state[k] - (1.0 - share) * body.points.reference[k];
  }
  return System(box, some_prescribed(body), state);
}

TEST(Ldlt, AgreesWithADenseSolveWhateverTheSigns) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    // Compressed to four tenths a bond's stiffness across, c s / l, is -1.5 c / L.
    for (const double share : {1.0, 0.4}) {
      SCOPED_TRACE(std::to_string(dimension) + "D, " + std::to_string(share));
      System system = compressed_system(dimension, share);
      const std::vector<double> eigenvalues = dense_eigenvalues(system);
      const auto negative = Index(std::count_if(eigenvalues.begin(), eigenvalues.end(),
                                                [](double value) { return value < 0.0; }));
      EXPECT_EQ(negative > 0, share < 1.0 && dimension > 1);
      Ldlt solver;
      ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
      ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
      EXPECT_LT(solution_error(system), 1e-9);
      ASSERT_TRUE(solver.inertia());
      EXPECT_EQ(solver.inertia()->negative, negative);
      EXPECT_EQ(solver.inertia()->positive, system.free.count() - negative);
      EXPECT_EQ(solver.statistics().factorisations, 1);

      // The next tangent, with the same pattern.
      system.assemble(std::vector<double>(system.body.dofs(), 0.0));
      ASSERT_EQ(system.solve(solver, FactorUse::may_reuse), LinearOutcome::solved);
      EXPECT_LT(solution_error(system), 1e-11);
      EXPECT_EQ(solver.inertia()->negative, 0);
      EXPECT_EQ(solver.statistics().factorisations, 2);
    }
  }
}

TEST(Ldlt, GivesTheSameBitsTwice) {
  System system = compressed_system(2, 0.4);
  std::vector<std::vector<double>> found;
  for (int k = 0; k < 2; ++k) {
    Ldlt solver;
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(system.solve(solver), LinearOutcome::solved);
    found.push_back(system.x);
  }
  EXPECT_EQ(found.front(), found.back());
}

TEST(Ldlt, NamesATangentWithoutStiffness) {
  // A straight row has none across.
  tests::BoxSetting row = tests::small_box(2);
  row.extent = {9, 1, 0};
  const BoxBody body(row);
  std::vector<char> prescribed(body.dofs(), 0);
  for (const std::size_t dof : {0, 1, 16, 17}) prescribed[dof] = 1;
  System system(row, prescribed, std::vector<double>(body.dofs(), 0.0));
  Ldlt solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  EXPECT_NE(system.solve(solver), LinearOutcome::solved);
}

TEST(Ldlt, RefusesValuesThatAreNotFinite) {
  System system = compressed_system(2, 1.0);
  Ldlt solver;
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  system.tangent.diagonal[40] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(system.solve(solver), LinearOutcome::singular);
  EXPECT_FALSE(solver.inertia());
}

TEST(Ldlt, TakesABodyWithoutFreeDegreesOfFreedom) {
  const tests::BoxSetting box = tests::small_box(2);
  const BoxBody body(box);
  System system(box, std::vector<char>(body.dofs(), 1), std::vector<double>(body.dofs(), 0.0));
  Ldlt solver;
  EXPECT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  EXPECT_EQ(system.solve(solver), LinearOutcome::solved);
  EXPECT_EQ(solver.inertia()->negative, 0);
}

}  // namespace
}  // namespace peristat
