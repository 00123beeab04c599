#include "solvers/load_stepping.hpp"

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

struct Followed {
  LoadSteppingResult result;
  std::vector<StepRecord> steps;
  std::vector<IterationRecord> iterations;
  std::vector<DecisionRecord> decisions;
  std::vector<std::vector<double>> displacements;
};

Followed follow(Problem& problem, const LoadSteppingOptions& options,
                const NewtonOptions& newton_options = {}, int interrupt_after = -1) {
  Followed followed;
  Cholesky solver;
  EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
  LoadSteppingObserver observer;
  observer.iteration = [&](const IterationRecord& row) { followed.iterations.push_back(row); };
  observer.decision = [&](const DecisionRecord& row) { followed.decisions.push_back(row); };
  observer.accepted = [&](const StepRecord& row, const AcceptedState& state) {
    followed.steps.push_back(row);
    followed.displacements.push_back(state.trial.displacement);
  };
  observer.interrupted = [&] { return int(followed.steps.size()) == interrupt_after; };
  followed.result = follow_loading({problem.assembler, solver, problem.tangent}, problem.conditions,
                                   options, newton_options, observer);
  return followed;
}

/// Held on the left; the right end moves along x by `stretch` of the length, and half as much
/// across.
std::vector<SupportSpecification> pulled(const tests::BoxSetting& box, double stretch,
                                         const std::string& program = "load") {
  const double length = box.extent[0] * box.spacing;
  const std::string along = std::to_string(stretch * length) + "*" + program;
  const std::string across = std::to_string(0.5 * stretch * length) + "*" + program;
  return {support("left", "0", "0", "0"), support("right", along, across, "0")};
}

LoadSteppingOptions steps(int count) {
  LoadSteppingOptions options;
  options.steps = count;
  return options;
}

/// What every run must satisfy: accepted load factors rise, each decision continues the last.
void expect_consistent(const Followed& followed) {
  ASSERT_EQ(followed.result.steps, int(followed.steps.size()));
  double reached = 0.0;
  std::size_t accepted = 0;
  for (const DecisionRecord& decision : followed.decisions) {
    EXPECT_EQ(decision.step, int(accepted) + 1);
    EXPECT_NEAR(decision.load_factor, reached + decision.increment, 1e-12);
    EXPECT_FALSE(decision.reason.empty());
    if (decision.action.rfind("accept", 0) != 0) continue;
    EXPECT_EQ(decision.outcome, "converged");
    ASSERT_LT(accepted, followed.steps.size());
    EXPECT_EQ(followed.steps[accepted].load_factor, decision.load_factor);
    EXPECT_EQ(followed.steps[accepted].step, int(accepted) + 1);
    EXPECT_GT(decision.load_factor, reached);
    reached = decision.load_factor;
    ++accepted;
  }
  EXPECT_EQ(accepted, followed.steps.size());
  EXPECT_EQ(followed.result.state.load_factor, reached);
  if (accepted > 0) {
    EXPECT_EQ(followed.result.state.displacement, followed.displacements.back());
  }
}

TEST(LoadStepping, TakesEqualStepsToTheFullLoad) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  for (int count : {1, 3, 7}) {
    const Followed followed = follow(problem, steps(count));
    ASSERT_EQ(followed.result.outcome, Outcome::converged);
    expect_consistent(followed);
    ASSERT_EQ(followed.steps.size(), std::size_t(count));
    for (int k = 0; k < count; ++k) {
      EXPECT_NEAR(followed.steps[k].load_factor, double(k + 1) / count, 1e-14);
      EXPECT_EQ(followed.steps[k].mode, "newton");
      EXPECT_GT(followed.steps[k].newton_iterations, 0);
    }
    EXPECT_EQ(followed.steps.back().load_factor, 1.0);  // exactly
    EXPECT_EQ(followed.iterations.front().step, 1);
    EXPECT_EQ(followed.iterations.back().step, count);
  }
}

// Three iterations are too few for the whole load and enough for a part of it; later parts, which
// move less, are easier.
TEST(LoadStepping, CutsAStepThatFailsAndGrowsItAgain) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.3, "sqrt(load)"), {});
  LoadSteppingOptions options = steps(1);
  options.easy_iterations = 3;
  NewtonOptions newton_options;
  newton_options.max_iterations = 3;
  const Followed followed = follow(problem, options, newton_options);
  ASSERT_EQ(followed.result.outcome, Outcome::converged);
  expect_consistent(followed);
  int cuts = 0, grown = 0;
  double increment = 1.0;
  for (const DecisionRecord& decision : followed.decisions) {
    EXPECT_LE(decision.increment, increment);  // less where only a rest is left
    increment = decision.next_increment;
    if (decision.action == "cut") {
      ++cuts;
      EXPECT_EQ(decision.outcome, "iteration_limit");
      EXPECT_DOUBLE_EQ(decision.next_increment, 0.5 * decision.increment);
    } else if (decision.action == "accept and grow") {
      ++grown;
      EXPECT_GT(cuts, 0);
    }
  }
  EXPECT_GE(cuts, 2);
  EXPECT_GE(grown, 1);
  EXPECT_EQ(followed.steps.back().load_factor, 1.0);

  // However it was reached, the equilibrium is that of one large step with enough iterations.
  const Followed at_once = follow(problem, steps(1));
  ASSERT_EQ(at_once.steps.size(), 1u);
  EXPECT_LT(tests::distance(followed.displacements.back(), at_once.displacements.back()),
            1e-8 * tests::norm(at_once.displacements.back()));
}

TEST(LoadStepping, NeverGrowsBeyondTheLargestStep) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  LoadSteppingOptions options = steps(16);
  options.largest_step = 0.25;
  options.easy_iterations = 100;
  const Followed followed = follow(problem, options);
  ASSERT_EQ(followed.result.outcome, Outcome::converged);
  expect_consistent(followed);
  double largest = 0.0;
  for (const DecisionRecord& decision : followed.decisions) {
    largest = std::max(largest, decision.increment);
  }
  EXPECT_EQ(largest, 0.25);
  // 1/16 + 1/8 + 1/4 + 1/4 + 1/4 and the rest of 1/16
  EXPECT_EQ(followed.steps.size(), 6u);

  options.largest_step = 0.03;  // also below 1 / steps
  EXPECT_EQ(follow(problem, options).steps.size(), 34u);
}

TEST(LoadStepping, StopsBelowTheSmallestStepWithTheOutcomesName) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.3), {});
  LoadSteppingOptions options = steps(1);
  options.smallest_step = 0.2;
  NewtonOptions newton_options;
  newton_options.max_iterations = 1;
  const Followed followed = follow(problem, options, newton_options);
  EXPECT_EQ(followed.result.outcome, Outcome::iteration_limit);
  EXPECT_EQ(followed.result.steps, 0);
  expect_consistent(followed);
  ASSERT_EQ(followed.decisions.size(), 3u);  // 1, 1/2, 1/4; an eighth is too small
  EXPECT_EQ(followed.decisions[0].action, "cut");
  EXPECT_EQ(followed.decisions[1].action, "cut");
  EXPECT_EQ(followed.decisions[2].action, "stop");
  EXPECT_EQ(followed.decisions[2].increment, 0.25);
  EXPECT_EQ(followed.decisions[2].outcome, "iteration_limit");
  EXPECT_NE(followed.decisions[2].reason.find("max_iterations"), std::string::npos);
  EXPECT_EQ(tests::norm(followed.result.state.displacement), 0.0);
}

TEST(LoadStepping, StopsAtTheFirstFailureUnlessAdaptive) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.3), {});
  LoadSteppingOptions options = steps(4);
  options.adaptive = false;
  NewtonOptions newton_options;
  newton_options.max_iterations = 1;
  const Followed followed = follow(problem, options, newton_options);
  EXPECT_EQ(followed.result.outcome, Outcome::iteration_limit);
  ASSERT_EQ(followed.decisions.size(), 1u);
  EXPECT_EQ(followed.decisions[0].action, "stop");
}

TEST(LoadStepping, DoesNotCutWhereASmallerStepCannotHelp) {
  Problem problem(tests::small_box(2), {support("left", "0")},
                  {tests::body_force("right", "1*load", "1*load")});
  const Followed followed = follow(problem, steps(1));
  EXPECT_EQ(followed.result.outcome, Outcome::singular_tangent);
  ASSERT_EQ(followed.decisions.size(), 1u);
  EXPECT_EQ(followed.decisions[0].action, "stop");
  EXPECT_EQ(followed.decisions[0].outcome, "singular_tangent");
}

TEST(LoadStepping, KeepsTheLastAcceptedStateWhenInterrupted) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  const Followed followed = follow(problem, steps(5), {}, 2);
  EXPECT_EQ(followed.result.outcome, Outcome::interrupted);
  EXPECT_EQ(followed.result.steps, 2);
  expect_consistent(followed);
  EXPECT_NEAR(followed.result.state.load_factor, 0.4, 1e-14);
  EXPECT_EQ(followed.decisions.back().action, "stop");
  EXPECT_EQ(followed.decisions.back().outcome, "interrupted");
}

TEST(LoadStepping, ReactionsBalanceTheLoads) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    Problem problem(tests::small_box(dimension), {support("left", "0", "0", "0")},
                    {tests::body_force("all", "0.01*load", "2e-4*load", "-1e-4*load")});
    const Followed followed = follow(problem, steps(2));
    ASSERT_EQ(followed.result.outcome, Outcome::converged);
    ASSERT_EQ(followed.steps.size(), 2u);
    for (const StepRecord& step : followed.steps) {
      std::vector<double> external(problem.body.dofs());
      problem.conditions.external_force(step.load_factor, external);
      double largest = 0.0;
      for (int c = 0; c < dimension; ++c) {
        double total = 0.0;
        for (std::size_t dof = c; dof < external.size(); dof += dimension) total += external[dof];
        largest = std::max(largest, std::abs(total));
        // 1e-10 of the forces' norm as residual, over some hundred degrees of freedom.
        EXPECT_NEAR(step.reactions.at("left")[c], -total, 1e-9 * largest);
      }
      EXPECT_GT(largest, 0.0);
    }
  }
}

/// Balance error of the first step from the unloaded state to a stretch.
StepRecord single_step(const tests::BoxSetting& box, double stretch, bool by_force) {
  std::vector<SupportSpecification> supports = pulled(box, stretch);
  std::vector<LoadSpecification> loads;
  if (by_force) {
    supports.pop_back();
    loads = {tests::body_force("right", std::to_string(10.0 * stretch) + "*load")};
  }
  Problem problem(box, supports, loads);
  NewtonOptions options;
  options.relative_tolerance = 1e-13;
  const Followed followed = follow(problem, steps(1), options);
  EXPECT_EQ(followed.result.outcome, Outcome::converged);
  return followed.steps.at(0);
}

TEST(LoadStepping, BalanceErrorFallsWithTheCubeOfAnElasticStep) {
  for (int dimension = 2; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    for (bool by_force : {false, true}) {
      const StepRecord coarse = single_step(box, 0.02, by_force);
      const StepRecord fine = single_step(box, 0.01, by_force);
      ASSERT_GT(coarse.stored_energy, 0.0);
      EXPECT_DOUBLE_EQ(coarse.balance_error, coarse.external_work - coarse.stored_energy);
      ASSERT_GT(std::abs(fine.balance_error), 1e-6 * fine.stored_energy);  // above round-off
      EXPECT_NEAR(std::log2(coarse.balance_error / fine.balance_error), 3.0, 0.1)
          << dimension << "D" << (by_force ? ", by force" : "");
    }
  }
}

TEST(LoadStepping, LedgerOfALinearBodyCloses) {
  // In 1D forces are linear in the displacement, for which the trapezoidal rule is exact.
  const tests::BoxSetting box = tests::small_box(1);
  Problem problem(box, pulled(box, 0.1), {tests::body_force("all", "0.3*load")});
  const Followed followed = follow(problem, steps(3));
  ASSERT_EQ(followed.steps.size(), 3u);
  for (const StepRecord& step : followed.steps) {
    EXPECT_GT(step.stored_energy, 0.0);
    EXPECT_NEAR(step.external_work / step.stored_energy, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace peristat
