#include "solvers/drivers/dynamics.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "solvers/study/study.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/lattice.hpp"

namespace peristat {
namespace {

/// A bar of ten points with two rows more on the left, which are held.
Points bar_points() {
  Lattice lattice;
  lattice.dimension = 1;
  lattice.spacing = 0.1;
  lattice.cross_section = 0.5;
  lattice.shapes = {{ShapeStep::Action::add, Box{{0.0}, {1.0}}}};
  lattice.layers = {{"left", {0, -1}, 2, ""}};
  return make_points(lattice);
}

/// Under its weight, which may change with the time.
BodySpecification hanging_bar(const std::string& weight) {
  BodySpecification of;
  of.horizon = 0.2015;
  of.material.youngs_modulus = 4.0;
  of.material.density = 2.0;
  of.supports = {{"left", {"0"}}};
  of.loads = {{LoadSpecification::Kind::gravity, "", {weight}}};
  of.end_time = 4.0;
  return of;
}

StudyOptions options_of(MotionScheme scheme, MotionStart start) {
  StudyOptions options;
  options.threads = 1;
  options.loading.mode = Mode::dynamics;
  options.loading.dynamics.time_step = 0.02;
  options.loading.dynamics.steps_per_row = 20;
  options.loading.dynamics.scheme = scheme;
  options.loading.dynamics.start = start;
  options.newton.relative_tolerance = 1e-12;
  return options;
}

StudyResult follow(BodySpecification of, const StudyOptions& options) {
  of.has_inertia = options.loading.dynamics.scheme == MotionScheme::newmark;
  return solve(*make_body(bar_points(), of, 1), options);
}

TEST(Dynamics, StaysInTheEquilibriumThatItBeginsIn) {
  for (const MotionScheme scheme : {MotionScheme::verlet, MotionScheme::newmark}) {
    const StudyResult still =
        follow(hanging_bar("1e-2"), options_of(scheme, MotionStart::equilibrium));
    ASSERT_EQ(still.outcome, Outcome::converged);
    ASSERT_GT(still.steps.size(), 5U);
    const double stored = still.steps.front().stored_energy;
    EXPECT_GT(stored, 0.0);
    for (const StepRecord& step : still.steps) {
      EXPECT_LT(step.motion->kinetic_energy, 1e-18 * stored);
      EXPECT_NEAR(step.stored_energy, stored, 1e-10 * stored);
      EXPECT_NEAR(step.balance_error, 0.0, 1e-10 * stored);
    }
    double swings = 0.0;
    for (const StepRecord& step :
         follow(hanging_bar("1e-2"), options_of(scheme, MotionStart::rest)).steps) {
      swings = std::max(swings, step.motion->kinetic_energy);
    }
    EXPECT_GT(swings, 0.1 * stored);
  }
}

TEST(Dynamics, SwingsAboutThePreloadAsAboutRest) {
  for (const MotionScheme scheme : {MotionScheme::verlet, MotionScheme::newmark}) {
    // Strains of 1e-7 or so: what loads do adds up.
    const StudyResult still =
        follow(hanging_bar("1e-7"), options_of(scheme, MotionStart::equilibrium));
    const StudyResult swings =
        follow(hanging_bar("t > 0 ? 3e-7 : 1e-7"), options_of(scheme, MotionStart::equilibrium));
    const StudyResult from_rest =
        follow(hanging_bar("t > 0 ? 2e-7 : 0"), options_of(scheme, MotionStart::rest));
    ASSERT_EQ(swings.outcome, Outcome::converged);
    ASSERT_EQ(from_rest.outcome, Outcome::converged);
    const std::size_t end = still.state.displacement.size() - 1;
    const double preload = still.state.displacement[end];
    EXPECT_GT(preload, 1e-8);
    EXPECT_NEAR(swings.state.displacement[end], preload + from_rest.state.displacement[end],
                1e-5 * preload);
  }
}

TEST(Dynamics, BeginsInNoEquilibriumThatDamages) {
  BodySpecification brittle = hanging_bar("1e-2");
  brittle.material.damage.law = DamageLaw::critical_stretch;
  brittle.material.damage.critical = 1e-3;
  const StudyResult result =
      follow(brittle, options_of(MotionScheme::verlet, MotionStart::equilibrium));
  EXPECT_EQ(result.outcome, Outcome::damage_begins);
  EXPECT_TRUE(result.steps.empty());
}

void expect_refused(const BodySpecification& of, const std::string& key) {
  try {
    static_cast<void>(follow(of, options_of(MotionScheme::verlet, MotionStart::equilibrium)));
    ADD_FAILURE() << "was not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), key);
  }
}

TEST(Dynamics, RefusesStartsThatAreNone) {
  BodySpecification moved = hanging_bar("1e-2");
  moved.initial.resize(1);
  moved.initial[0].displacement[0] = "1e-3*x";
  expect_refused(moved, "initial[0].displacement");
  BodySpecification free = hanging_bar("0");
  free.supports.clear();
  expect_refused(free, "supports");
}

TEST(Dynamics, GoesOnWithTheLastStepWhereNothingHoldsAnyMore) {
  BodySpecification dust = hanging_bar("0");
  dust.material.damage.law = DamageLaw::critical_stretch;
  dust.material.damage.critical = 1e-3;
  dust.initial.resize(1);
  dust.initial[0].velocity[0] = "x > 0 ? 10*(x + 0.2) : 0";
  StudyOptions options = options_of(MotionScheme::verlet, MotionStart::rest);
  options.loading.dynamics.time_step = 0.0;
  options.loading.dynamics.steps_per_row = 1;
  const StudyResult result = follow(dust, options);
  ASSERT_EQ(result.outcome, Outcome::converged);
  EXPECT_DOUBLE_EQ(result.state.stage, 4.0);
  EXPECT_NEAR(result.state.displacement.back(), 4.0 * 10.0 * (0.95 + 0.2), 1e-9);
}

TEST(Dynamics, BearsLoadsThatSetInWithinAStep) {
  for (const std::string weight : {"1e-3*t", "t < 2 ? 0 : 1e-3", "1e-6 + (t < 2 ? 0 : 1e-3)"}) {
    for (const MotionScheme scheme : {MotionScheme::verlet, MotionScheme::newmark}) {
      StudyOptions options = options_of(scheme, MotionStart::rest);
      options.loading.dynamics.steps_per_row = 1;
      if (scheme == MotionScheme::newmark) options.loading.dynamics.spectral_radius = 0.0;
      const StudyResult result = follow(hanging_bar(weight), options);
      EXPECT_EQ(result.outcome, Outcome::converged) << weight;
      EXPECT_EQ(result.steps.size(), 201U) << weight;
    }
  }
}

}  // namespace
}  // namespace peristat
