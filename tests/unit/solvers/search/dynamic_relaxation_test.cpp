#include "solvers/search/dynamic_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Dense>
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

struct Relaxed {
  RelaxationResult result;
  std::vector<IterationRecord> records;
  RelaxationMotion motion;
};

Relaxed relaxed(Problem& problem, const State& from, double load_factor,
                const RelaxationOptions& options, const RelaxationMotion& motion = {},
                int interrupt_at = -1) {
  Relaxed run;
  run.motion = motion;
  run.result = relax(problem.equilibrium, problem.tangent, from, load_factor, options, run.motion,
                     [&](const IterationRecord& row) {
                       run.records.push_back(row);
                       return row.iteration == interrupt_at;
                     });
  return run;
}

std::vector<double> by_newton(Problem& problem) {
  Cholesky solver;
  EXPECT_EQ(problem.analyze(solver), LinearOutcome::solved);
  NewtonOptions options;
  options.relative_tolerance = 1e-13;
  const NewtonResult result = newton(problem.equilibrium, solver, problem.tangent,
                                     problem.at_rest(), 1.0, options, nullptr);
  EXPECT_EQ(result.outcome, Outcome::converged);
  return result.state.displacement;
}

RelaxationOptions tight() {
  RelaxationOptions options;
  options.relative_tolerance = 1e-12;
  return options;
}

RelaxationOptions kinetic() {
  RelaxationOptions options = tight();
  options.damping = Damping::kinetic;
  options.mass_factor = 2.0;
  return options;
}

std::string text(double number) { return std::to_string(number); }

/// Held on the left; the right end moves by `stretch` of the length, and half as much across.
std::vector<SupportSpecification> pulled(const tests::BoxSetting& box, double stretch) {
  const double length = box.extent[0] * box.spacing;
  return {support("left", "0", "0", "0"), support("right", text(stretch * length) + "*load",
                                                  text(0.5 * stretch * length) + "*load", "0")};
}

struct Case {
  std::string name;
  std::vector<SupportSpecification> supports;
  std::vector<LoadSpecification> loads;
};

/// The same body pulled at its end, by body forces, and by both.
std::vector<Case> cases(const tests::BoxSetting& box) {
  const std::vector<SupportSpecification> held{support("left", "0", "0", "0")};
  return {{"supports", pulled(box, 0.05), {}},
          {"loads", held, {tests::body_force("all", "0.02*load", "-2e-4*load", "2e-4*load")}},
          {"both", pulled(box, 0.05), {tests::body_force("all", "0", "-0.02*load")}}};
}

TEST(DynamicRelaxation, ReachesTheEquilibriumThatNewtonFinds) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    for (const Case& one : cases(box)) {
      Problem problem(box, one.supports, one.loads);
      const std::vector<double> expected = by_newton(problem);
      ASSERT_GT(norm(expected), 0.0);
      for (const RelaxationOptions& options : {tight(), kinetic()}) {
        SCOPED_TRACE(std::to_string(dimension) + "D, " + one.name +
                     (options.damping == Damping::kinetic ? ", kinetic" : ", adaptive"));
        const Relaxed run = relaxed(problem, problem.at_rest(), 1.0, options);
        ASSERT_EQ(run.result.outcome, Outcome::converged);
        // The residual is 1e-12 of the forces; the condition of the tangent makes 1e-8 of it.
        EXPECT_LT(distance(run.result.state.displacement, expected), 1e-8 * norm(expected));
        EXPECT_TRUE(run.motion.velocity.empty());
        EXPECT_GE(run.result.iterations, options.ramp);

        // What it tells of its last state is true.
        std::vector<double> gradient(problem.body.dofs()), external(problem.body.dofs());
        const Evaluation found =
            problem.assembler.gradient(run.result.state.displacement, gradient);
        problem.conditions.external_force(1.0, external);
        EXPECT_EQ(found.energy, run.result.state.stored_energy);
        EXPECT_EQ(gradient, run.result.state.gradient);
        EXPECT_EQ(external, run.result.external_force);
        double squared = 0.0;
        for (const Index dof : problem.free.dof) {
          squared += std::pow(external[dof] - gradient[dof], 2);
        }
        // Both are sums of the same numbers, that cancel to 1e-12 of the forces' scale.
        EXPECT_NEAR(std::sqrt(squared), run.result.state.residual_norm, 1e-14 * run.result.scale);
        EXPECT_LE(std::sqrt(squared), 1.01e-12 * run.result.scale);
      }
    }
  }
}

TEST(DynamicRelaxation, EquilibriumDoesNotDependOnThreads) {
  const tests::BoxSetting box = tests::small_box(2);
  for (const Case& one : cases(box)) {
    SCOPED_TRACE(one.name);
    Problem single(box, one.supports, one.loads, 1), two(box, one.supports, one.loads, 2);
    const Relaxed a = relaxed(single, single.at_rest(), 1.0, tight());
    const Relaxed b = relaxed(two, two.at_rest(), 1.0, tight());
    ASSERT_EQ(a.result.outcome, Outcome::converged);
    ASSERT_EQ(b.result.outcome, Outcome::converged);
    const std::vector<double>& u = a.result.state.displacement;
    EXPECT_LT(distance(b.result.state.displacement, u), 1e-8 * norm(u));
    EXPECT_NEAR(b.result.external_work / a.result.external_work, 1.0, 1e-8);
    EXPECT_NEAR(b.result.drained_energy, a.result.drained_energy,
                1e-8 * std::abs(a.result.external_work));
  }
}

TEST(DynamicRelaxation, IsReproducibleToTheLastBit) {
  const tests::BoxSetting box = tests::small_box(2);
  for (const int threads : {1, 2}) {
    Problem problem(box, pulled(box, 0.05), {}, threads);
    const Relaxed first = relaxed(problem, problem.at_rest(), 1.0, tight());
    const Relaxed again = relaxed(problem, problem.at_rest(), 1.0, tight());
    EXPECT_EQ(again.result.state.displacement, first.result.state.displacement);
    EXPECT_EQ(again.result.drained_energy, first.result.drained_energy);
  }
}

TEST(DynamicRelaxation, WhatIsDrainedIsTheWorkThatIsNotStoredAndWhatDampingTook) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    for (const Case& one : cases(box)) {
      Problem problem(box, one.supports, one.loads);
      for (RelaxationOptions options : {tight(), kinetic()}) {
        SCOPED_TRACE(std::to_string(dimension) + "D, " + one.name +
                     (options.damping == Damping::kinetic ? ", kinetic" : ", adaptive"));
        // Of the work, from rest by a fast and by a slow ramp, and from a loaded state.
        const auto disagreement = [&](const State& from, int ramp, State& end) {
          options.ramp = ramp;
          const double before = problem.assembler.energy(from.displacement).energy;
          const RelaxationResult result = relaxed(problem, from, 1.0, options).result;
          EXPECT_EQ(result.outcome, Outcome::converged);
          EXPECT_GT(result.external_work, 0.0);
          EXPECT_NEAR(result.drained_energy,
                      result.external_work - (result.state.stored_energy - before),
                      1e-14 * result.external_work);
          if (ramp == 10) {
            EXPECT_GT(result.drained_energy, 0.05 * result.external_work);
          }
          end = {result.state.displacement, 1.0};
          return std::abs(result.damped_energy - result.drained_energy) / result.external_work;
        };
        State end, half = problem.at_rest();
        const double fast = disagreement(problem.at_rest(), 10, end);
        const double slow = disagreement(problem.at_rest(), 100, end);
        options.ramp = 10;
        const RelaxationResult to_half = relaxed(problem, half, 0.5, options).result;
        half = {to_half.state.displacement, 0.5};
        const double from_half = disagreement(half, 10, end);
        if (dimension == 1) {
          // Forces are linear in the displacement, for which the trapezoidal rule is exact.
          EXPECT_LT(std::max({fast, slow, from_half}), 1e-13);
        } else {
          // The rule's error is of third order in the displacement of an iteration: 3.4e-4 of the
          // work of a strain of 0.05 within ten iterations, 1.4e-6 within a hundred.
          EXPECT_LT(std::max(fast, from_half), 1e-3);
          EXPECT_LT(slow, 1e-5);
          EXPECT_LT(slow, 0.5 * fast);
        }
      }
    }
  }
}

TEST(DynamicRelaxation, WorkOfLoadsIsThatOfDeadLoadsAfterAJump) {
  // With a ramp of one iteration loads have half their values on the first, tiny way and their
  // whole ones on the rest.
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, {support("left", "0", "0")},
                  {tests::body_force("all", "0.02*load", "-2e-4*load")});
  RelaxationOptions options = tight();
  options.ramp = 1;
  const Relaxed run = relaxed(problem, problem.at_rest(), 1.0, options);
  ASSERT_EQ(run.result.outcome, Outcome::converged);
  const double dead = tests::dot(run.result.external_force, run.result.state.displacement);
  // The body starts from rest without a residual: it does not move in the first iteration.
  EXPECT_NEAR(run.result.external_work / dead, 1.0, 1e-12);
  // Of the work of dead loads on a linear body half is drained; this one is nearly linear.
  EXPECT_NEAR(run.result.drained_energy / run.result.external_work, 0.5, 0.05);
}

TEST(DynamicRelaxation, EndsEarlierByTheDisplacementTolerance) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  const Relaxed whole = relaxed(problem, problem.at_rest(), 1.0, tight());
  RelaxationOptions options = tight();
  options.displacement_tolerance = 1e-6;
  const Relaxed early = relaxed(problem, problem.at_rest(), 1.0, options);
  EXPECT_EQ(early.result.outcome, Outcome::converged);
  EXPECT_LT(early.result.iterations, whole.result.iterations);
  EXPECT_GT(early.result.state.residual_norm, 1e-12 * early.result.scale);
  EXPECT_LT(distance(early.result.state.displacement, whole.result.state.displacement),
            1e-2 * norm(whole.result.state.displacement));
}

TEST(DynamicRelaxation, NamesTheIterationLimit) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  RelaxationOptions options = tight();
  options.ramp = 20;
  options.max_iterations = 30;
  const Relaxed run = relaxed(problem, problem.at_rest(), 1.0, options);
  EXPECT_EQ(run.result.outcome, Outcome::iteration_limit);
  EXPECT_EQ(run.result.iterations, 50);
  EXPECT_GT(run.result.state.residual_norm, 1e-12 * run.result.scale);
  ASSERT_FALSE(run.records.empty());
  EXPECT_EQ(run.records.back().iteration, 50);
  EXPECT_EQ(run.records.back().residual, run.result.state.residual_norm);
  EXPECT_GT(run.records.back().relative_residual, 1e-12);
}

TEST(DynamicRelaxation, CanBeInterrupted) {
  const tests::BoxSetting box = tests::small_box(2);
  Problem problem(box, pulled(box, 0.05), {});
  const Relaxed whole = relaxed(problem, problem.at_rest(), 1.0, tight());
  ASSERT_GT(whole.result.iterations, 200);
  const Relaxed run = relaxed(problem, problem.at_rest(), 1.0, tight(), {}, 200);
  EXPECT_EQ(run.result.outcome, Outcome::interrupted);
  EXPECT_EQ(run.result.iterations, 200);
  EXPECT_EQ(run.records.front().iteration, 100);
}

TEST(DynamicRelaxation, NamesADegenerateState) {
  // The right end is driven onto the left end, in numbers without round-off.
  tests::BoxSetting box = tests::small_box(1);
  box.extent = {3, 0, 0};
  box.spacing = 0.125;
  Problem problem(box, {support("left", "0"), support("right", "-0.25*load")}, {});
  ASSERT_EQ(problem.body.model.bonds().count(), 3);
  RelaxationOptions options = tight();
  options.ramp = 8;  // shares of the way that are exact
  const Relaxed run = relaxed(problem, problem.at_rest(), 1.0, options);
  EXPECT_EQ(run.result.outcome, Outcome::degenerate);
  EXPECT_LE(run.result.iterations, 8);  // a point in between may be passed before
  EXPECT_EQ(relaxed(problem, problem.at_rest(), 0.5, options).result.outcome, Outcome::converged);
}

TEST(DynamicRelaxation, LeavesSupportsAndLoadsExactlyAtTheirTargets) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxSetting box = tests::small_box(dimension);
    const Case both = cases(box)[2];
    Problem problem(box, both.supports, both.loads);
    for (const bool holds : {true, false}) {
      for (const int ramp : {1, 7, 100}) {
        State from = problem.at_rest();
        for (const double load_factor : {0.3, 0.7, 1.0}) {
          RelaxationOptions options;
          options.ramp = ramp;
          options.holds = holds;
          options.relative_tolerance = 1e-6;
          const Relaxed run = relaxed(problem, from, load_factor, options);
          ASSERT_EQ(run.result.outcome, Outcome::converged);
          std::vector<double> target = run.result.state.displacement, force(problem.body.dofs());
          problem.conditions.prescribe(load_factor, target);
          problem.conditions.external_force(load_factor, force);
          EXPECT_EQ(run.result.state.displacement, target) << load_factor << ", " << ramp;
          EXPECT_EQ(run.result.external_force, force) << load_factor << ", " << ramp;
          from = {run.result.state.displacement, load_factor};
        }
      }
    }
  }
}

TEST(DynamicRelaxation, KeepsItsMotionWhereALoadDoesNotHold) {
  // In 1D the tangent, of which the density is made, is constant. Adaptive damping depends on
  // forces one iteration ago, which are the same where one run ends and the next begins.
  const tests::BoxSetting box = tests::small_box(1);
  for (const Case& one : cases(box)) {
    SCOPED_TRACE(one.name);
    Problem problem(box, one.supports, one.loads);
    RelaxationOptions options;
    options.holds = false;
    options.ramp = 40;
    const Relaxed half = relaxed(problem, problem.at_rest(), 0.5, options);
    ASSERT_EQ(half.result.outcome, Outcome::converged);
    EXPECT_EQ(half.result.iterations, 40);
    ASSERT_EQ(half.motion.velocity.size(), std::size_t(problem.free.count()));
    EXPECT_GT(norm(half.motion.velocity), 0.0);
    const State from{half.result.state.displacement, 0.5};
    const Relaxed whole = relaxed(problem, from, 1.0, options, half.motion);
    const Relaxed stopped = relaxed(problem, from, 1.0, options);
    options.ramp = 80;
    const Relaxed at_once = relaxed(problem, problem.at_rest(), 1.0, options);
    EXPECT_EQ(at_once.result.iterations, 80);
    const std::vector<double>& expected = at_once.result.state.displacement;
    // Round-off of eighty iterations.
    EXPECT_LT(distance(whole.result.state.displacement, expected), 1e-12 * norm(expected));
    EXPECT_LT(distance(whole.motion.velocity, at_once.motion.velocity),
              1e-11 * norm(at_once.motion.velocity));
    EXPECT_NEAR(
        (half.result.external_work + whole.result.external_work) / at_once.result.external_work,
        1.0, 1e-11);
    EXPECT_GT(distance(stopped.result.state.displacement, expected), 1e-6 * norm(expected));
  }
}

BondPotential weak(double micromodulus) {
  return Degraded<TanhDegradation>{micromodulus, TanhDegradation::continuous(0.02, 0.06, 3.0)};
}

/// A strip whose right end is torn off in part.
struct Strip {
  tests::BoxSetting box;
  std::vector<SupportSpecification> supports;
  explicit Strip(double stretch) {
    box = tests::small_box(2);
    box.potential = weak;
    supports = pulled(box, stretch);
  }
};

TEST(DynamicRelaxation, CommitsOnTheWayOnlyWhereBreakingIsTransient) {
  const Strip strip(0.02);
  for (const Breaking breaking : {Breaking::at_equilibrium, Breaking::transient}) {
    Problem problem(strip.box, strip.supports, {}, 2);
    RelaxationOptions options;
    options.breaking = breaking;
    options.relative_tolerance = 1e-8;
    const Relaxed run = relaxed(problem, problem.at_rest(), 1.0, options);
    ASSERT_EQ(run.result.outcome, Outcome::converged);
    const Trial& found = run.result.state;
    std::vector<double> damage(std::size_t(problem.body.points.count()));
    const DamageState state = assess_damage(problem.body.model, found.history, {}, damage);
    if (breaking == Breaking::at_equilibrium) {
      EXPECT_EQ(tests::largest(bond_stretches(problem.body.model, found.history)), 0.0);
      EXPECT_EQ(run.result.growth.degrading, 0);
      EXPECT_EQ(run.result.growth.breaking, 0);
      // It would damage bonds if it were accepted.
      EXPECT_GT(problem.assembler.growth(found.at()).breaking, 0);
    } else {
      EXPECT_GT(state.broken_bonds, 0);
      EXPECT_EQ(run.result.growth.breaking, state.broken_bonds);  // each of them once
      EXPECT_GE(run.result.growth.degrading, state.broken_bonds);
      EXPECT_EQ(problem.assembler.growth(found.at()).degrading, 0);
      EXPECT_NEAR(
          run.result.drained_energy + run.result.state.stored_energy + state.dissipated_energy,
          run.result.external_work, 1e-13 * run.result.external_work);
    }
    EXPECT_EQ(run.result.released_energy, 0.0);
  }
}

TEST(DynamicRelaxation, LeavesEquilibriumAloneThatNothingDisturbs) {
  Problem problem(tests::small_box(2), {support("left", "0", "0")}, {});
  RelaxationOptions options;
  const Relaxed run = relaxed(problem, problem.at_rest(), 1.0, options);
  EXPECT_EQ(run.result.outcome, Outcome::converged);
  EXPECT_EQ(run.result.state.displacement, problem.at_rest().displacement);
  EXPECT_EQ(run.result.iterations, std::max(options.ramp, options.quiet_iterations));
}

TEST(DynamicRelaxation, DensityIsStable) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.perturbation = 0.2;
    if (dimension == 3) box.extent = {4, 3, 3};
    Problem problem(box, {support("left", "0", "0", "0")}, {});
    State from = problem.at_rest();
    tests::Random random(4);
    for (const Index dof : problem.free.dof) {
      from.displacement[dof] = 0.02 * box.spacing * random.number();
    }
    for (const double mass_factor : {1.0, 2.0}) {
      // One iteration from rest moves every degree of freedom by F / (2 lambda).
      RelaxationOptions options;
      options.ramp = 1;
      options.holds = false;
      options.mass_factor = mass_factor;
      std::vector<double> gradient(problem.body.dofs());
      (void)problem.assembler.gradient(from.displacement, gradient);
      const Relaxed run = relaxed(problem, from, 0.0, options);
      const auto n = Eigen::Index(problem.free.count());
      Eigen::VectorXd density(n);
      for (Eigen::Index e = 0; e < n; ++e) {
        const Index dof = problem.free.dof[std::size_t(e)];
        const double moved = run.result.state.displacement[dof] - from.displacement[dof];
        density[e] = -gradient[dof] / (2.0 * moved);
        ASSERT_GT(density[e], 0.0);
      }
      problem.assembler.tangent(from.displacement, problem.tangent);
      Eigen::MatrixXd k(n, n);
      std::vector<double> unit(problem.body.dofs(), 0.0), column(problem.body.dofs());
      for (Eigen::Index e = 0; e < n; ++e) {
        unit[problem.free.dof[std::size_t(e)]] = 1.0;
        problem.tangent.multiply(unit, column);
        unit[problem.free.dof[std::size_t(e)]] = 0.0;
        for (Eigen::Index r = 0; r < n; ++r) k(r, e) = column[problem.free.dof[std::size_t(r)]];
      }
      const Eigen::VectorXd root = density.cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd scaled = root.asDiagonal() * k * root.asDiagonal();
      const double largest =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
              .eigenvalues()
              .maxCoeff();
      EXPECT_LT(largest, 4.0 / mass_factor);  // the explicit steps of time 1 are stable
      EXPECT_GT(largest, 1.0 / mass_factor);  // and no shorter than need be by far
    }
  }
}

}  // namespace
}  // namespace peristat
