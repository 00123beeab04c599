#include "solvers/drivers/step_zero.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/drivers/load_stepping.hpp"
#include "src/conditions/preload.hpp"
#include "src/parallel/communicator.hpp"
#include "tests/softening_strip.hpp"

namespace peristat {
namespace {

using tests::body_force;
using tests::Problem;
using tests::support;

struct Followed {
  LoadSteppingResult result;
  std::vector<StepRecord> rows;
  std::vector<std::vector<double>> displacements;
  std::vector<DecisionRecord> decisions;
};

template <class AnyProblem>
Followed follow(AnyProblem& problem, const LoadSteppingOptions& options) {
  Followed followed;
  Cholesky solver;
  EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
  LoadSteppingObserver observer;
  observer.decision = [&](const DecisionRecord& row) { followed.decisions.push_back(row); };
  observer.accepted = [&](const StepRecord& row, const AcceptedState& state) {
    followed.rows.push_back(row);
    followed.displacements.push_back(state.trial.displacement);
  };
  followed.result = follow_loading({{problem.assembler, solver, problem.tangent, problem.free},
                                    problem.conditions,
                                    options,
                                    {},
                                    observer});
  return followed;
}

LoadSteppingOptions options_of(const Mode& mode, int steps) {
  LoadSteppingOptions options;
  options.mode = mode;
  options.steps = options.relaxation_steps = steps;
  return options;
}

/// Of the last entries, relative to the largest of the second.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0, off = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    off = std::max(off, std::abs(a[k] - b[k]));
    largest = std::max(largest, std::abs(b[k]));
  }
  return off / largest;
}

std::vector<SupportSpecification> held_left() { return {support("left", "0", "0", "0")}; }

TEST(Preload, IsWhatActsAtLoadZero) {
  const tests::BoxSetting box = tests::small_box(2);
  const auto preload = [&](const std::string& displacement, const std::string& force) {
    const Problem problem(box, {support("left", "0", "0"), support("right", displacement)},
                          {body_force("all", force, "0")});
    return find_preload(problem.conditions, sole_rank());
  };
  EXPECT_FALSE(preload("0.01*load", "5*load").acts());
  EXPECT_EQ(preload("0.01*load", "5*load").description(), "");
  EXPECT_EQ(preload("0.01 + load", "0").displacement, 0.01);
  const Preload pulled = preload("0", "5 + load");
  EXPECT_TRUE(pulled.acts());
  EXPECT_GT(pulled.force[0], 0.0);
  EXPECT_EQ(pulled.force[0], pulled.force_size);
  EXPECT_NE(pulled.description().find("loads of"), std::string::npos);
}

TEST(Preload, IsPutOnInProportion) {
  const tests::BoxSetting box = tests::small_box(2);
  const Problem problem(box, {support("left", "0", "0"), support("right", "0.02 + load")},
                        {body_force("all", "3 - load", "0")});
  std::vector<double> whole(problem.body.dofs()), half = whole;
  problem.conditions.external_force(0.0, whole);
  problem.conditions.external_force(LoadPoint::of_preload(0.5), half);
  EXPECT_GT(whole[0], 0.0);
  for (std::size_t k = 0; k < whole.size(); ++k) EXPECT_EQ(half[k], 0.5 * whole[k]);
  std::vector<double> displacement(problem.body.dofs(), 0.0);
  problem.conditions.prescribe(LoadPoint::of_preload(0.25), displacement);
  EXPECT_EQ(*std::max_element(displacement.begin(), displacement.end()), 0.005);
}

TEST(StepZero, IsTheBodyAtRestWhereNothingActs) {
  Problem problem(tests::small_box(2), {support("left", "0", "0"), support("right", "0.01*load")},
                  {});
  for (const Mode& mode : {Mode::newton, Mode::relaxation, Mode::adaptive}) {
    const Followed followed = follow(problem, options_of(mode, 2));
    ASSERT_EQ(followed.result.outcome, Outcome::converged);
    ASSERT_EQ(followed.rows.size(), 3u);
    EXPECT_EQ(followed.result.steps, 2);
    const StepRecord& zero = followed.rows.front();
    EXPECT_EQ(zero.step, 0);
    EXPECT_EQ(zero.load_factor, 0.0);
    EXPECT_EQ(zero.external_work, 0.0);
    EXPECT_EQ(zero.stored_energy, 0.0);
    EXPECT_EQ(zero.newton_iterations + zero.relaxation_iterations, 0);
    EXPECT_EQ(followed.rows[1].step, 1);
  }
}

/// A dead load that is there from the start is at step 0 what it is at the end of a ramp, whatever
/// the mode and the number of steps, and its work is what is stored.
TEST(StepZero, IsTheEndOfARamp) {
  const tests::BoxSetting box = tests::small_box(2);
  const std::string force = "3e9";
  Problem ramped(box, held_left(), {body_force("right", "0", force + "*load")});
  Problem dead(box, held_left(), {body_force("right", "0", force)});
  const Followed ramp = follow(ramped, options_of(Mode::newton, 200));
  ASSERT_EQ(ramp.result.outcome, Outcome::converged);
  const StepRecord& end = ramp.rows.back();
  double largest = 0.0;
  for (const double u : ramp.displacements.back()) largest = std::max(largest, std::abs(u));
  ASSERT_GT(largest, 0.05 * box.extent[0] * box.spacing);  // so that it is not linear
  for (const Mode& mode : {Mode::newton, Mode::relaxation, Mode::adaptive}) {
    for (const int steps : {1, 10}) {
      SCOPED_TRACE(std::string(mode.name) + " " + std::to_string(steps));
      const Followed followed = follow(dead, options_of(mode, steps));
      ASSERT_EQ(followed.result.outcome, Outcome::converged);
      ASSERT_EQ(followed.rows.size(), std::size_t(steps) + 1);
      const StepRecord& zero = followed.rows.front();
      EXPECT_EQ(zero.step, 0);
      EXPECT_LT(difference(followed.displacements.front(), ramp.displacements.back()), 1e-7);
      EXPECT_NEAR(zero.stored_energy / end.stored_energy, 1.0, 1e-8);
      EXPECT_NEAR(zero.external_work / zero.stored_energy, 1.0, 1e-13);
      // The trapezoidal rule over 200 steps.
      EXPECT_NEAR(zero.external_work / end.external_work, 1.0, 1e-4);
      EXPECT_NEAR(followed.rows.back().external_work / zero.external_work, 1.0, 1e-10);
      EXPECT_LT(difference(followed.displacements.back(), followed.displacements.front()), 1e-7);
    }
  }
}

TEST(StepZero, ReportsWhatWasPutOn) {
  Problem dead(tests::small_box(2), held_left(), {body_force("right", "0", "1e6")});
  const Followed followed = follow(dead, options_of(Mode::newton, 1));
  int reports = 0;
  for (const DecisionRecord& decision : followed.decisions) {
    if (decision.action != Decision::preload) continue;
    ++reports;
    EXPECT_EQ(decision.step, 0);
    EXPECT_EQ(decision.load_factor, 0.0);
    EXPECT_NE(decision.reason.find("loads of"), std::string::npos);
  }
  EXPECT_EQ(reports, 1);
}

/// What damages is put on in steps of the programme, in each of which the ledger is closed.
TEST(StepZero, FollowsDamageInSteps) {
  // Beyond its peak the notched strip has no equilibrium for Newton's method.
  for (const auto& [mode, drawn] : {std::pair(Mode::newton, "0.012"), {Mode::adaptive, "0.03"}}) {
    SCOPED_TRACE(std::string(mode.name));
    tests::Strip strip(tests::Strip::Middle::notched, tests::drawn(drawn));
    const Followed followed = follow(strip, options_of(mode, 20));
    ASSERT_FALSE(followed.rows.empty());
    const StepRecord& zero = followed.rows.front();
    EXPECT_EQ(zero.step, 0);
    EXPECT_GT(zero.dissipated_energy + double(zero.broken_bonds), 0.0);
    bool reports = false;
    for (const DecisionRecord& decision : followed.decisions) {
      const bool is_preload = decision.action == Decision::preload;
      reports |= is_preload && decision.reason.find("damage") != std::string::npos;
    }
    EXPECT_TRUE(reports);
  }
}

TEST(LoadingProgramme, KnowsWhereALoadIsNew) {
  const LoadingProgramme programme({{0.0, 1.0, 0.2, -1.5}, {0.0, 0.0, 0.0, 0.0}});
  for (const double stage : {0.1, 1.0, 2.9, 3.0}) EXPECT_TRUE(programme.is_at_new_load(stage));
  for (const double stage : {0.0, 1.1, 2.0, 2.5}) EXPECT_FALSE(programme.is_at_new_load(stage));
  // A load that rests is no new one, one beside it may be.
  const LoadingProgramme both({{0.0, 1.0, 1.0, 1.0}, {0.0, 0.0, 1.0, 0.0}});
  EXPECT_TRUE(both.is_at_new_load(1.5));
  EXPECT_FALSE(both.is_at_new_load(2.5));
}

}  // namespace
}  // namespace peristat
