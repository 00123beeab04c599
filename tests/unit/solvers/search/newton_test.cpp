#include "solvers/search/newton.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::Problem;
using tests::support;

struct Solved {
  NewtonResult result;
  std::vector<IterationRecord> iterations;
};

Solved solve(Problem& problem, const State& from, double load_factor = 1.0,
             const NewtonOptions& options = {}, int stop_after = -1) {
  Solved solved;
  Cholesky solver;
  EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
  solved.result = newton(problem.equilibrium, solver, problem.tangent, from, load_factor, options,
                         [&](const IterationRecord& row) {
                           solved.iterations.push_back(row);
                           return row.iteration == stop_after;
                         });
  return solved;
}

/// A plate or block held on the left, its right end displaced by `stretch` of its length and
/// sheared.
std::vector<SupportSpecification> pulled(const tests::BoxSetting& box, double stretch) {
  const double length = box.extent[0] * box.spacing;
  const std::string along = std::to_string(stretch * length) + "*load";
  const std::string across = std::to_string(0.5 * stretch * length) + "*load";
  return {support("left", "0", "0", "0"), support("right", along, across, "0")};
}

TEST(Newton, ConvergesQuadratically) {
  for (int dimension = 2; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    Problem problem(box, pulled(box, 0.2), {});
    NewtonOptions options;
    options.relative_tolerance = 1e-13;
    const Solved solved = solve(problem, problem.at_rest(), 1.0, options);
    ASSERT_EQ(solved.result.outcome, Outcome::converged);
    // log r_(k+1) = 2 log r_k + constant: the observed order over three residuals.
    int orders = 0;
    for (std::size_t k = 1; k + 1 < solved.iterations.size(); ++k) {
      const double before = solved.iterations[k - 1].relative_residual;
      const double now = solved.iterations[k].relative_residual;
      const double after = solved.iterations[k + 1].relative_residual;
      if (before > 0.05 || after < 1e-14) continue;  // not near yet; all round-off
      ++orders;
      EXPECT_NEAR(std::log(after / now) / std::log(now / before), 2.0, 0.25) << dimension << "D";
    }
    EXPECT_GE(orders, 1) << dimension << "D";
    EXPECT_LE(solved.result.iterations, 7);
    EXPECT_GT(solved.result.state.stored_energy, 0.0);
    ASSERT_TRUE(solved.result.inertia);
    EXPECT_EQ(solved.result.inertia->positive, problem.free.count());
  }
}

TEST(Newton, FindsTheMinimumOfTheEnergy) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.1), {tests::body_force("all", "0", "-0.01*load")});
  const Solved solved = solve(problem, problem.at_rest());
  ASSERT_EQ(solved.result.outcome, Outcome::converged);
  const std::vector<double>& found = solved.result.state.displacement;
  tests::Random random(1);
  for (int repeat = 0; repeat < 5; ++repeat) {
    std::vector<double> other = found;
    for (Index dof : problem.free.dof) other[dof] += 1e-3 * box.spacing * random.number();
    const double energy =
        problem.assembler.energy(other).energy - tests::dot(solved.result.external_force, other);
    EXPECT_GT(energy, solved.result.state.total_energy);
  }
}

TEST(Newton, SolvesALinearProblemWithItsPredictorAlone) {
  // In 1D the energy is quadratic, so that the consistent predictor is the solution.
  const tests::BoxSetting box = tests::small_box(1);
  Problem problem(box, pulled(box, 0.1), {tests::body_force("all", "0.5")});
  const Solved solved = solve(problem, problem.at_rest());
  EXPECT_EQ(solved.result.outcome, Outcome::converged);
  EXPECT_EQ(solved.result.iterations, 1);
  ASSERT_EQ(solved.iterations.size(), 2u);
  EXPECT_GT(solved.iterations[0].residual, 0.0);
}

TEST(Newton, PrescribesTheJumpExactly) {
  const tests::BoxSetting box = tests::small_box(3);
  Problem problem(box, pulled(box, 0.1), {});
  const Solved solved = solve(problem, problem.at_rest(), 0.5);
  ASSERT_EQ(solved.result.outcome, Outcome::converged);
  std::vector<double> expected(problem.body.dofs(), 1e300);
  problem.conditions.prescribe(0.5, expected);
  int prescribed = 0;
  double largest = 0.0;
  for (std::size_t dof = 0; dof < expected.size(); ++dof) {
    if (expected[dof] == 1e300) continue;
    ++prescribed;
    largest = std::max(largest, expected[dof]);
    EXPECT_EQ(solved.result.state.displacement[dof], expected[dof]);
  }
  EXPECT_EQ(prescribed, int(problem.body.dofs()) - problem.free.count());
  EXPECT_NEAR(largest, 0.5 * 0.1 * box.extent[0] * box.spacing, 1e-15);
}

TEST(Newton, RecordsTheStateAfterTheJumpAsIterationZero) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.1), {tests::body_force("all", "0", "-0.01*load")});
  const Solved solved = solve(problem, problem.at_rest());
  ASSERT_GE(solved.iterations.size(), 3u);
  // Recomputed: free points stand still, prescribed ones have jumped.
  std::vector<double> jumped(problem.body.dofs(), 0.0), gradient(problem.body.dofs()),
      external(problem.body.dofs());
  problem.conditions.prescribe(1.0, jumped);
  problem.conditions.external_force(1.0, external);
  const double energy = problem.assembler.gradient(jumped, gradient).energy;
  double squared = 0.0;
  for (Index dof : problem.free.dof) squared += std::pow(external[dof] - gradient[dof], 2);
  const IterationRecord& zero = solved.iterations[0];
  EXPECT_EQ(zero.iteration, 0);
  EXPECT_EQ(zero.step_length, 0.0);
  EXPECT_NEAR(zero.residual / std::sqrt(squared), 1.0, 1e-13);
  EXPECT_NEAR(zero.energy / (energy - tests::dot(external, jumped)), 1.0, 1e-13);
  // The jump is larger than the forces here, so that it is the scale of the residuals.
  ASSERT_GT(std::sqrt(squared), tests::norm(external));
  EXPECT_DOUBLE_EQ(zero.relative_residual, 1.0);
  for (std::size_t k = 0; k < solved.iterations.size(); ++k) {
    EXPECT_EQ(solved.iterations[k].iteration, int(k));
    EXPECT_DOUBLE_EQ(solved.iterations[k].relative_residual,
                     solved.iterations[k].residual / zero.residual);
  }
  EXPECT_EQ(solved.result.iterations, int(solved.iterations.size()) - 1);
  EXPECT_EQ(solved.iterations.back().residual, solved.result.state.residual_norm);
}

TEST(Newton, ContinuesFromAnEquilibrium) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.1), {});
  const Solved half = solve(problem, problem.at_rest(), 0.5);
  const Solved whole = solve(problem, {half.result.state.displacement, 0.5}, 1.0);
  const Solved at_once = solve(problem, problem.at_rest(), 1.0);
  ASSERT_EQ(whole.result.outcome, Outcome::converged);
  const auto& expected = at_once.result.state.displacement;
  ASSERT_GT(tests::distance(half.result.state.displacement, expected), 0.1 * tests::norm(expected));
  EXPECT_LT(tests::distance(whole.result.state.displacement, expected),
            1e-8 * tests::norm(expected));
}

TEST(Newton, StaysAtAnEquilibriumThatNothingDisturbs) {
  Problem problem(tests::small_box(2), {support("left", "0", "0")}, {});
  const Solved solved = solve(problem, problem.at_rest());
  EXPECT_EQ(solved.result.outcome, Outcome::converged);
  EXPECT_EQ(solved.result.iterations, 0);
  EXPECT_EQ(solved.result.state.displacement, problem.at_rest().displacement);
}

TEST(Newton, NamesTheIterationLimit) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.2), {});
  NewtonOptions options;
  options.max_iterations = 2;
  const Solved solved = solve(problem, problem.at_rest(), 1.0, options);
  EXPECT_EQ(solved.result.outcome, Outcome::iteration_limit);
  EXPECT_EQ(solved.result.iterations, 2);
  EXPECT_GT(solved.iterations.back().relative_residual, options.relative_tolerance);
}

TEST(Newton, CanBeInterrupted) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.2), {});
  for (int stop_after : {0, 1}) {
    const Solved solved = solve(problem, problem.at_rest(), 1.0, {}, stop_after);
    EXPECT_EQ(solved.result.outcome, Outcome::interrupted);
    EXPECT_EQ(solved.iterations.size(), std::size_t(stop_after) + 1);
  }
}

TEST(Newton, NamesASingularTangent) {
  // Nothing holds the body along y.
  Problem problem(tests::small_box(2), {support("left", "0")},
                  {tests::body_force("right", "1", "1")});
  const Solved solved = solve(problem, problem.at_rest());
  EXPECT_EQ(solved.result.outcome, Outcome::singular_tangent);
}

TEST(Newton, NamesNegativePivots) {
  // Compressed by half in its plane: every bond pushes, and the inside would rather fold.
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, {support("left", "0", "0"), support("right", "0", "0")},
                  {tests::body_force("all", "1e-3", "2e-3")});
  State folded = problem.at_rest();
  for (std::size_t k = 0; k < folded.displacement.size(); ++k) {
    folded.displacement[k] = -0.6 * problem.body.points.reference[k];
  }
  NewtonOptions exact_only;
  exact_only.projection = Projection::never;
  const Solved solved = solve(problem, folded, 1.0, exact_only);
  EXPECT_EQ(solved.result.outcome, Outcome::not_positive_definite);
  EXPECT_TRUE(solved.result.unstable_start);
  ASSERT_TRUE(solved.result.inertia);
  EXPECT_GT(solved.result.inertia->negative, 0);
}

TEST(Newton, LeavesAnUnstableStateAlongProjectedTangents) {
  // The same state, let go: a minimum of the energy is there to be found.
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, {support("left", "0", "0"), support("right", "0", "0")},
                  {tests::body_force("all", "1e-3", "2e-3")});
  State folded = problem.at_rest();
  for (Index dof : problem.free.dof) {
    folded.displacement[dof] = -0.6 * problem.body.points.reference[dof];
  }
  NewtonOptions options;
  options.max_iterations = 100;
  const Solved solved = solve(problem, folded, 1.0, options);
  EXPECT_EQ(solved.result.outcome, Outcome::converged);
  EXPECT_TRUE(solved.result.unstable_start);
  bool projected = false;
  for (std::size_t k = 1; k < solved.iterations.size(); ++k) {
    const IterationRecord& row = solved.iterations[k];
    if (row.projection > 0.0) {
      projected = true;
      EXPECT_NE(row.negative_pivots, 0);
    }
    // The first iteration is the predictor; from then on the energy falls.
    if (k > 1) {
      EXPECT_LE(row.energy, solved.iterations[k - 1].energy * (1.0 + 1e-12));
    }
  }
  EXPECT_TRUE(projected);
  EXPECT_EQ(solved.iterations.back().projection, 0.0);  // the last one is exact, and quadratic
  const Solved rest = solve(problem, problem.at_rest(), 1.0, options);
  ASSERT_EQ(rest.result.outcome, Outcome::converged);
}

TEST(Newton, ProjectsFromTheStartWhenAsked) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.2), {});
  NewtonOptions options;
  options.projection = Projection::always;
  options.max_iterations = 200;
  const Solved projected = solve(problem, problem.at_rest(), 1.0, options);
  const Solved exact = solve(problem, problem.at_rest());
  ASSERT_EQ(projected.result.outcome, Outcome::converged);
  ASSERT_EQ(exact.result.outcome, Outcome::converged);
  for (std::size_t k = 1; k < projected.iterations.size(); ++k) {
    EXPECT_EQ(projected.iterations[k].projection, 1.0);
  }
  EXPECT_GT(projected.result.iterations, exact.result.iterations);
  EXPECT_LT(tests::distance(projected.result.state.displacement, exact.result.state.displacement),
            1e-8 * tests::norm(exact.result.state.displacement));
}

TEST(Newton, WithoutAPredictorLinearisesAboutTheStateAfterTheJump) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.1), {});
  NewtonOptions options;
  options.predictor = Predictor::none;
  const Solved without = solve(problem, problem.at_rest(), 1.0, options);
  const Solved with = solve(problem, problem.at_rest());
  ASSERT_EQ(without.result.outcome, Outcome::converged);
  ASSERT_EQ(with.result.outcome, Outcome::converged);
  EXPECT_EQ(without.iterations[0].residual, with.iterations[0].residual);
  // The jump bends the bonds beside the support; the predictor goes around that.
  EXPECT_GT(without.iterations[1].residual, 2.0 * with.iterations[1].residual);
  EXPECT_LT(tests::distance(without.result.state.displacement, with.result.state.displacement),
            1e-8 * tests::norm(with.result.state.displacement));
}

TEST(Newton, NamesADegenerateState) {
  // The right end is driven onto the left end, in numbers without round-off.
  tests::BoxSetting box = tests::small_box(1);
  box.extent = {3, 0, 0};
  box.spacing = 0.125;
  Problem problem(box, {support("left", "0"), support("right", "-0.25*load")}, {});
  ASSERT_EQ(problem.body.model.bonds().count(), 3);
  EXPECT_EQ(solve(problem, problem.at_rest()).result.outcome, Outcome::degenerate);
  EXPECT_EQ(solve(problem, problem.at_rest(), 0.5).result.outcome, Outcome::converged);
}

TEST(Outcomes, HaveNamesAndExplanationsOfTheirOwn) {
  std::vector<std::string> names, explanations;
  for (int k = 0; k <= int(Outcome::interrupted); ++k) {
    names.push_back(name(Outcome(k)));
    explanations.push_back(explanation(Outcome(k)));
    EXPECT_FALSE(names.back().empty());
    EXPECT_FALSE(explanations.back().empty());
  }
  for (auto* texts : {&names, &explanations}) {
    std::sort(texts->begin(), texts->end());
    EXPECT_EQ(std::adjacent_find(texts->begin(), texts->end()), texts->end());
  }
}

}  // namespace
}  // namespace peristat
