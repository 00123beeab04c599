#include "solvers/motion/newmark.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/terms/springs/inertia_term.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

/// A free body with inertia, and masses of its own.
struct FreeBody {
  explicit FreeBody(int dimension)
      : body(tests::points_with_ends(tests::small_box(dimension)), tests::small_box(dimension)),
        conditions(body.points, {}, {}),
        free(conditions.prescribed(), dimension) {
    body.model.add(std::make_shared<InertiaTerm>(body.points));
    assembler.emplace(body.points, body.model, 1);
    tangent.emplace(BlockPattern(body.model.bonds()), dimension);
    EXPECT_EQ(solver.analyze(tangent->pattern, free), LinearOutcome::solved);
    setting.mass.assign(body.dofs(), 0.01);
  }

  [[nodiscard]] Newmark motion(double spectral_radius, NewtonOptions options = {}) {
    State start{std::vector<double>(body.dofs()), 0.0, assembler->initial_history()};
    for (std::size_t k = 0; k < start.displacement.size(); ++k) {
      start.displacement[k] = 1e-3 * std::sin(0.4 * double(k));
    }
    return {EquilibriumProblem{*assembler, conditions, free},
            setting,
            start,
            std::vector<double>(body.dofs(), 0.25),
            {},
            spectral_radius,
            {solver, *tangent, options, {}}};
  }

  tests::BoxBody body;
  Conditions conditions;
  FreeDofs free;
  std::optional<Assembler> assembler;
  std::optional<Tangent> tangent;
  Cholesky solver;
  MotionSetting setting;
};

double energy_of(Newmark& motion) {
  EXPECT_TRUE(motion.find_energy());
  return motion.kinetic_energy() + motion.at().stored_energy;
}

TEST(NewmarkCoefficients, AreThoseOfChungAndHulbert) {
  const NewmarkCoefficients average(1.0), annihilating(0.0);
  EXPECT_DOUBLE_EQ(average.beta, 0.25);
  EXPECT_DOUBLE_EQ(average.gamma, 0.5);
  EXPECT_DOUBLE_EQ(annihilating.of_inertia, -1.0);
  EXPECT_DOUBLE_EQ(annihilating.of_force, 0.0);
  EXPECT_DOUBLE_EQ(annihilating.gamma, 1.5);
  EXPECT_DOUBLE_EQ(annihilating.beta, 1.0);
  for (const double rho : {0.0, 0.3, 0.8, 1.0}) {  // of second order
    const NewmarkCoefficients of(rho);
    EXPECT_NEAR(of.gamma, 0.5 - of.of_inertia + of.of_force, 1e-15);
  }
}

TEST(Newmark, KeepsTheEnergyOfALinearBodyAtAnyStep) {
  for (const double dt : {0.01, 1.0, 50.0}) {
    FreeBody body(1);
    Newmark motion = body.motion(1.0);
    const double before = energy_of(motion);
    for (int step = 1; step <= 5; ++step) {
      ASSERT_EQ(motion.step(dt, step * dt), Outcome::converged);
      EXPECT_NEAR(energy_of(motion), before, 1e-9 * before);
    }
  }
}

TEST(Newmark, KeepsTheMomentumOfAFreeBody) {
  for (const double rho : {1.0, 0.4}) {
    FreeBody body(2);
    Newmark motion = body.motion(rho);
    for (int step = 1; step <= 5; ++step) {
      ASSERT_EQ(motion.step(0.1, 0.1 * step), Outcome::converged);
      double sum = 0.0;
      for (const double velocity : motion.velocity()) sum += velocity;
      EXPECT_NEAR(sum, 0.25 * double(body.body.dofs()), 1e-9 * double(body.body.dofs()));
    }
  }
}

TEST(Newmark, AStepThatFailsChangesNothing) {
  FreeBody body(2);
  body.setting.absorption.assign(body.body.dofs(), 0.5);
  NewtonOptions hurried;
  hurried.max_iterations = 1;
  hurried.relative_tolerance = 1e-14;
  Newmark motion = body.motion(1.0, hurried);
  const std::vector<double> place = motion.at().displacement, velocity = motion.velocity();
  EXPECT_EQ(motion.step(5.0, 5.0), Outcome::iteration_limit);
  EXPECT_EQ(motion.at().displacement, place);
  EXPECT_EQ(motion.velocity(), velocity);
  EXPECT_EQ(motion.time(), 0.0);
  EXPECT_EQ(motion.sums().absorbed, 0.0);
}

TEST(Newmark, CountsWhatLayersAbsorb) {
  FreeBody body(1);
  body.setting.absorption.assign(body.body.dofs(), 0.5);
  Newmark motion = body.motion(1.0);
  const double before = energy_of(motion);
  for (int step = 1; step <= 20; ++step) {
    ASSERT_EQ(motion.step(0.1, 0.1 * step), Outcome::converged);
  }
  EXPECT_GT(motion.sums().absorbed, 0.5 * before);
  EXPECT_NEAR(energy_of(motion) + motion.sums().absorbed, before, 1e-9 * before);
}

}  // namespace
}  // namespace peristat
