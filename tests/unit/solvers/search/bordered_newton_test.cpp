#include "solvers/search/bordered_newton.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/linear/ldlt.hpp"
#include "solvers/search/softest_mode.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::body_force;
using tests::Problem;
using tests::support;

const IterationObserver nobody;

LoadPoint at_stage(double stage) { return stage; }

/// A strip that is held on the left, moved on the right and loaded throughout, all of it by the
/// square of the load.
struct Pulled : Problem {
  Ldlt solver;

  Pulled()
      : Problem(tests::small_box(2),
                {support("left", "0", "0"), support("right", "0.1*load^2", "0.05*load")},
                {body_force("all", "0.02*load", "0.3*load^2")}) {
    EXPECT_EQ(analyze(solver), LinearOutcome::solved);
  }

  [[nodiscard]] std::vector<double> equilibrium_at(double stage) {
    Cholesky cholesky;
    EXPECT_EQ(analyze(cholesky), LinearOutcome::solved);
    const NewtonResult found =
        newton(equilibrium, cholesky, tangent, at_rest(), stage, NewtonOptions(), nobody);
    EXPECT_EQ(found.outcome, Outcome::converged);
    return found.state.displacement;
  }
};

TEST(BorderedNewton, FindsTheLoadOfADisplacement) {
  Pulled problem;
  const double load = 0.8;
  const std::vector<double> expected = problem.equilibrium_at(load);
  const std::vector<double> weights = tests::Random(7).vector(expected.size());
  double value = 0.0;
  for (std::size_t k = 0; k < weights.size(); ++k) value += weights[k] * expected[k];
  BorderedStep step{at_stage, {weights, 0.25, value + 0.25 * load}, 0.0, {}};
  for (const bool predicts : {false, true}) {
    SCOPED_TRACE(predicts);
    if (predicts) step.prediction = {problem.equilibrium_at(0.7), 0.7};
    std::vector<double> residuals;
    const BorderedResult found =
        bordered_newton(problem.equilibrium, problem.solver, problem.tangent, problem.at_rest(),
                        step, NewtonOptions(), [&](const IterationRecord& row) {
                          residuals.push_back(row.relative_residual);
                          return false;
                        });
    ASSERT_EQ(found.newton.outcome, Outcome::converged);
    EXPECT_NEAR(found.unknown, load, 1e-9);
    EXPECT_LT(tests::distance(found.newton.state.displacement, expected),
              1e-8 * tests::norm(expected));
    // Quadratic, until round-off.
    const std::size_t last = residuals.size() - 1;
    ASSERT_GE(last, 2u);
    EXPECT_LT(residuals[last], 1e-10);
    EXPECT_LT(residuals[last], 100.0 * residuals[last - 1] * residuals[last - 1] + 1e-13);
  }
}

TEST(BorderedNewton, TellsARateThatDifferencesConfirm) {
  Pulled problem;
  const double load = 0.6, h = 1e-4;
  const std::vector<double> here = problem.equilibrium_at(load),
                            before = problem.equilibrium_at(load - h),
                            after = problem.equilibrium_at(load + h);
  std::vector<double> rate;
  ASSERT_EQ(
      find_rate(problem.equilibrium, problem.solver, problem.tangent, {here}, at_stage, load, rate),
      LinearOutcome::solved);
  double error = 0.0;
  for (std::size_t k = 0; k < rate.size(); ++k) {
    error = std::max(error, std::abs(rate[k] - (after[k] - before[k]) / (2.0 * h)));
  }
  EXPECT_LT(error, 1e-6 * tests::norm(rate));
}

TEST(BorderedNewton, TellsABorderThatDoesNotAnswer) {
  Problem problem(tests::small_box(2), {support("left", "0", "0")}, {});
  Ldlt solver;
  ASSERT_EQ(problem.analyze(solver), LinearOutcome::solved);
  const std::vector<double> weights(problem.body.dofs(), 1.0);
  const BorderedResult found =
      bordered_newton(problem.equilibrium, solver, problem.tangent, problem.at_rest(),
                      {at_stage, {weights, 0.0, 0.1}, 0.0, {}}, NewtonOptions(), nobody);
  EXPECT_EQ(found.newton.outcome, Outcome::no_answer);
}

TEST(BorderedNewton, DifferencesConditionsOnOneSideWhereTheyEnd) {
  Problem problem(tests::small_box(2), {support("left", "0", "0")},
                  {body_force("right", "0.01*(load + sqrt(load)^2)")});
  Ldlt solver;
  ASSERT_EQ(problem.analyze(solver), LinearOutcome::solved);
  const std::vector<double> weights(problem.body.dofs(), 1.0);
  const BorderedResult found =
      bordered_newton(problem.equilibrium, solver, problem.tangent, problem.at_rest(),
                      {at_stage, {weights, 0.0, 0.1}, 0.0, {}}, NewtonOptions(), nobody);
  EXPECT_EQ(found.newton.outcome, Outcome::converged);
  EXPECT_GT(found.unknown, 0.0);
}

TEST(SoftestMode, IsAnEigenvector) {
  Problem problem(tests::small_box(2), {support("left", "0", "0")}, {});
  Ldlt solver;
  ASSERT_EQ(problem.analyze(solver), LinearOutcome::solved);
  std::vector<double> mode;
  const std::vector<double> rest(problem.body.dofs(), 0.0);
  ASSERT_EQ(find_softest_mode(problem.equilibrium, solver, problem.tangent, {rest}, mode),
            LinearOutcome::solved);
  EXPECT_NEAR(tests::norm(mode), 1.0, 1e-12);
  std::vector<double> image(mode.size());
  problem.tangent.multiply(mode, image);
  double eigenvalue = 0.0, error = 0.0;
  for (const Index dof : problem.free.dof) eigenvalue += mode[dof] * image[dof];
  for (const Index dof : problem.free.dof) {
    error = std::max(error, std::abs(image[dof] - eigenvalue * mode[dof]));
  }
  EXPECT_GT(eigenvalue, 0.0);
  EXPECT_LT(error, 1e-5 * eigenvalue);
}

}  // namespace
}  // namespace peristat
