#include "solvers/search/flow.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/terms/damage.hpp"
#include "solvers/search/newton.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::distance;
using tests::norm;
using tests::Problem;
using tests::support;

struct Flowed {
  RelaxationResult result;
  std::vector<IterationRecord> records;
};

Flowed flowed(Problem& problem, const State& from, double stage, const RelaxationOptions& options) {
  Cholesky solver;
  EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
  Flowed run;
  run.result = flow(problem.equilibrium, solver, problem.tangent, from, stage, options,
                    [&](const IterationRecord& row) {
                      run.records.push_back(row);
                      return false;
                    });
  return run;
}

BondPotential weak(double micromodulus) {
  return Degraded<TanhDegradation>{micromodulus, TanhDegradation::continuous(0.02, 0.06, 3.0)};
}

/// The right end moves by `stretch` of the length, and half as much across.
std::vector<SupportSpecification> pulled(const tests::BoxSetting& box, double stretch) {
  const double move = stretch * box.extent[0] * box.spacing;
  return {support("left", "0", "0", "0"), support("right", std::to_string(move) + "*load",
                                                  std::to_string(0.5 * move) + "*load", "0")};
}

/// The strip that tears, stretched evenly to where its ends belong.
struct EvenlyPulled {
  tests::BoxSetting box = tests::small_box(2);
  Problem problem;
  State from;

  EvenlyPulled(double stretch, int threads)
      : problem(weakened(box), pulled(box, stretch), {}, threads), from(problem.at_rest()) {
    from.stage = 1.0;
    const double move = stretch * box.extent[0] * box.spacing;
    for (Index i = 0; i < problem.body.points.count(); ++i) {
      const double share =
          (problem.body.points.position(i)[0] / box.spacing - 0.5) / (box.extent[0] - 1);
      from.displacement[std::size_t(i) * 2] = share * move;
      from.displacement[std::size_t(i) * 2 + 1] = 0.5 * share * move;
    }
    problem.conditions.prescribe(1.0, from.displacement);
  }

  static tests::BoxSetting& weakened(tests::BoxSetting& box) {
    box.potential = weak;
    return box;
  }
};

TEST(Flow, EndsAnElasticStepInAFewSolves) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    for (const bool loaded : {false, true}) {
      SCOPED_TRACE(std::to_string(dimension) + (loaded ? "D, loads" : "D, supports"));
      Problem problem(box, loaded ? std::vector{support("left", "0", "0", "0")} : pulled(box, 0.01),
                      loaded ? std::vector{tests::body_force("all", "0.02*load", "-2e-5*load")}
                             : std::vector<LoadSpecification>{});
      Cholesky solver;
      ASSERT_EQ(problem.analyze(solver), LinearOutcome::solved);
      const NewtonResult expected =
          newton(problem.equilibrium, solver, problem.tangent, problem.at_rest(), 1.0, {}, nullptr);
      ASSERT_EQ(expected.outcome, Outcome::converged);
      const Flowed run = flowed(problem, problem.at_rest(), 1.0, {});
      ASSERT_EQ(run.result.outcome, Outcome::converged);
      const std::vector<double>& u = expected.state.displacement;
      ASSERT_GT(norm(u), 0.0);
      // The residual is 1e-10 of the forces; the condition of the tangent makes 1e-7 of it.
      EXPECT_LT(distance(run.result.state.displacement, u), 1e-7 * norm(u));
      // Each solve gains two digits or so: strains of some per cent change the tangent by as much.
      EXPECT_LE(run.result.iterations, 12);
      EXPECT_LE(run.result.state.residual_norm, run.result.largest_residual);
      EXPECT_NEAR(run.result.drained_energy + run.result.state.stored_energy,
                  run.result.external_work, 1e-13 * run.result.external_work);
    }
  }
}

TEST(Flow, IsExactInOneSolveWhereTheBodyIsLinear) {
  // Bonds between neighbours in one dimension: the force is linear in the displacement.
  const tests::BoxSetting box = tests::small_box(1);
  Problem problem(box, pulled(box, 0.05), {});
  const Flowed run = flowed(problem, problem.at_rest(), 1.0, {});
  ASSERT_EQ(run.result.outcome, Outcome::converged);
  EXPECT_EQ(run.result.iterations, 2);  // the predictor, and the direction after it
}

/// A point between two that are held apart, on bonds that soften: where both bonds are whole it has
/// a well, beyond a barrier on either side one of them is gone.
TEST(Flow, EndsInTheWellInWhichItBegins) {
  tests::BoxSetting box = tests::small_box(1);
  box.extent = {3, 0, 0};
  box.horizon_ratio = 1.015;
  box.potential = [](double micromodulus) -> BondPotential {
    return Degraded<TanhDegradation>{micromodulus, TanhDegradation::continuous(0.04, 0.06, 3.0)};
  };
  const double apart = 0.07 * box.spacing;
  Problem problem(box, {support("left", "0"), support("right", std::to_string(apart) + "*load")},
                  {});
  ASSERT_EQ(problem.free.count(), 1);
  const Index dof = problem.free.dof[0];
  const auto force_at = [&](double place) {
    State at = problem.at_rest();
    problem.conditions.prescribe(1.0, at.displacement);
    at.displacement[dof] = place;
    std::vector<double> gradient(problem.body.dofs());
    (void)problem.assembler.gradient(at, gradient);
    return -gradient[dof];
  };
  int moved_left = 0, moved_right = 0, broken = 0;
  for (const double tolerance : {0.5, 0.1}) {
    for (int k = 1; k < 40; ++k) {
      const double start = apart * (k + 0.37) / 41.0;
      SCOPED_TRACE("from " + std::to_string(start / apart));
      State from = problem.at_rest();
      from.stage = 1.0;
      problem.conditions.prescribe(1.0, from.displacement);
      from.displacement[dof] = start;
      RelaxationOptions options;
      options.scale = 1e-3;
      options.flow_tolerance = tolerance;
      const Flowed run = flowed(problem, from, 1.0, options);
      ASSERT_EQ(run.result.outcome, Outcome::converged);
      const double end = run.result.state.displacement[dof];
      const double force = force_at(start);
      ASSERT_NE(force, 0.0);
      (end > start ? moved_right : moved_left) += 1;
      broken += problem.assembler.growth(run.result.state.at()).breaking > 0;
      // The force never changes its sign on the way: the first equilibrium downhill is where it
      // ends, but for the little that the residual's tolerance leaves.
      for (int share = 0; share <= 980; ++share) {
        EXPECT_GT(force_at(start + 1e-3 * share * (end - start)) * force, 0.0) << share;
      }
    }
  }
  EXPECT_GT(moved_left, 0);
  EXPECT_GT(moved_right, 0);
  EXPECT_GT(broken, 0);
  EXPECT_LT(broken, 78);
}

TEST(Flow, LosesEnergyInEveryStep) {
  for (const Breaking breaking : {Breaking::at_equilibrium, Breaking::transient}) {
    EvenlyPulled strip(0.03, 1);
    RelaxationOptions options;
    options.breaking = breaking;
    options.relative_tolerance = 1e-8;
    const Flowed run = flowed(strip.problem, strip.from, 1.0, options);
    ASSERT_EQ(run.result.outcome, Outcome::converged);
    ASSERT_GT(run.records.size(), 10u);
    for (std::size_t k = 1; k < run.records.size(); ++k) {
      EXPECT_LE(run.records[k].energy, run.records[k - 1].energy * (1.0 + 1e-14)) << k;
    }
    const Trial& found = run.result.state;
    EXPECT_EQ(run.result.external_work, 0.0);  // the supports stand still
    EXPECT_GT(run.result.drained_energy, 0.0);
    const DamageGrowth growth = strip.problem.assembler.growth(found.at());
    std::vector<double> damage(std::size_t(strip.problem.body.points.count()));
    const DamageState state = assess_damage(strip.problem.body.model, found.history, {}, damage);
    if (breaking == Breaking::transient) {
      EXPECT_GT(state.broken_bonds, 0);
      EXPECT_EQ(run.result.growth.breaking, state.broken_bonds);
      EXPECT_EQ(growth.degrading, 0);
    } else {
      EXPECT_EQ(state.broken_bonds, 0);
      EXPECT_GT(growth.breaking, 0);
    }
  }
}

TEST(Flow, IsTheSameOnAnyNumberOfThreads) {
  for (const Breaking breaking : {Breaking::at_equilibrium, Breaking::transient}) {
    RelaxationOptions options;
    options.breaking = breaking;
    options.relative_tolerance = 1e-8;
    EvenlyPulled single(0.03, 1);
    const Flowed expected = flowed(single.problem, single.from, 1.0, options);
    ASSERT_EQ(expected.result.outcome, Outcome::converged);
    const std::vector<double>& u = expected.result.state.displacement;
    for (const int threads : {2, 3}) {
      EvenlyPulled strip(0.03, threads);
      const Flowed run = flowed(strip.problem, strip.from, 1.0, options);
      ASSERT_EQ(run.result.outcome, Outcome::converged);
      EXPECT_EQ(run.result.iterations, expected.result.iterations);
      EXPECT_EQ(run.result.growth.breaking, expected.result.growth.breaking);
      EXPECT_LT(distance(run.result.state.displacement, u), 1e-9 * norm(u));
    }
  }
}

TEST(Flow, TellsWhereItDoesNotArrive) {
  EvenlyPulled strip(0.03, 1);
  RelaxationOptions options;
  options.max_iterations = 3;
  const Flowed run = flowed(strip.problem, strip.from, 1.0, options);
  EXPECT_EQ(run.result.outcome, Outcome::iteration_limit);
  EXPECT_GT(run.result.state.residual_norm, run.result.largest_residual);
}

}  // namespace
}  // namespace peristat
