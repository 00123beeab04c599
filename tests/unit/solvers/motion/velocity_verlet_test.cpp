#include "solvers/motion/velocity_verlet.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::Problem;
using tests::small_box;

MotionSetting unit_masses(const Problem& problem) {
  MotionSetting setting;
  setting.mass.assign(problem.body.points.reference.size(), 0.01);
  return setting;
}

/// A bar whose points are displaced by sine waves.
State waves(const Problem& problem) {
  State state = problem.at_rest();
  for (std::size_t k = 0; k < state.displacement.size(); ++k) {
    state.displacement[k] = 1e-3 * std::sin(0.4 * double(k));
  }
  return state;
}

/// Kinetic and stored energy, plain and modified.
struct Energies {
  double plain, modified;
};
Energies energies(VelocityVerlet& motion, double dt) {
  EXPECT_TRUE(motion.find_energy());
  const double plain = motion.kinetic_energy() + motion.at().stored_energy;
  return {plain, plain - dt * dt / 8.0 * motion.squared_force()};
}

TEST(VelocityVerlet, ConservesTheModifiedEnergyOfALinearBody) {
  Problem problem(small_box(1), {}, {});
  const MotionSetting setting = unit_masses(problem);
  double last_error = 0.0;
  for (const double dt : {0.02, 0.01, 0.005}) {
    const State start = waves(problem);
    VelocityVerlet motion(problem.equilibrium, setting, start,
                          std::vector<double>(start.displacement.size(), 0.0));
    const Energies before = energies(motion, dt);
    double error = 0.0;
    for (int step = 1; step * dt <= 1.0; ++step) {
      ASSERT_EQ(motion.step(dt, step * dt), Outcome::converged);
      const Energies now = energies(motion, dt);
      EXPECT_NEAR(now.modified, before.modified, 1e-12 * before.plain);
      error = std::max(error, std::abs(now.plain - before.plain));
    }
    motion.complete_sums();
    EXPECT_NEAR(energies(motion, dt).plain - before.plain, motion.sums().correction,
                1e-12 * before.plain);
    EXPECT_GT(error, 1e-6 * before.plain);
    if (last_error > 0.0) {
      EXPECT_NEAR(last_error / error, 4.0, 0.2);
    }
    last_error = error;
  }
}

TEST(VelocityVerlet, GoesBackTheWayItCame) {
  Problem problem(small_box(2), {tests::support("left", "0", "0")}, {});
  const MotionSetting setting = unit_masses(problem);
  const State start = waves(problem);
  State from = start;
  for (const Index point : problem.body.points.sets.at("left")) {
    from.displacement[std::size_t(point) * 2] = from.displacement[std::size_t(point) * 2 + 1] = 0.0;
  }
  VelocityVerlet there(problem.equilibrium, setting, from,
                       std::vector<double>(from.displacement.size(), 0.0));
  for (int step = 1; step <= 50; ++step) {
    ASSERT_EQ(there.step(0.02, 0.02 * step), Outcome::converged);
  }
  std::vector<double> back = there.velocity();
  for (double& component : back) component = -component;
  State turned = from;
  turned.displacement = there.at().displacement;
  VelocityVerlet again(problem.equilibrium, setting, turned, std::move(back));
  for (int step = 1; step <= 50; ++step) {
    ASSERT_EQ(again.step(0.02, 0.02 * step), Outcome::converged);
  }
  for (std::size_t k = 0; k < from.displacement.size(); ++k) {
    EXPECT_NEAR(again.at().displacement[k], from.displacement[k], 1e-14);
    EXPECT_NEAR(again.velocity()[k], 0.0, 1e-12);
  }
}

TEST(VelocityVerlet, CountsTheWorkOfLoadsAndOfSupportsThatMove) {
  Problem problem(small_box(1), {tests::support("left", "0")},
                  {tests::body_force("right", "0.01")});
  const MotionSetting setting = unit_masses(problem);
  const State start = problem.at_rest();
  const double dt = 0.01;
  VelocityVerlet motion(problem.equilibrium, setting, start,
                        std::vector<double>(start.displacement.size(), 0.0));
  const double at_start = dt * dt / 8.0 * motion.squared_force();
  for (int step = 1; step <= 80; ++step) ASSERT_EQ(motion.step(dt, dt * step), Outcome::converged);
  const Energies now = energies(motion, dt);
  EXPECT_GT(motion.sums().work, 0.0);
  EXPECT_NEAR(now.modified + at_start, motion.sums().work, 1e-12 * motion.sums().work);
}

TEST(VelocityVerlet, NoticesValuesThatAreNotFinite) {
  Problem problem(small_box(2), {}, {});
  const MotionSetting setting = unit_masses(problem);
  const State start = problem.at_rest();
  std::vector<double> velocity(start.displacement.size(), 0.0);
  velocity[5] = 1e300;
  VelocityVerlet motion(problem.equilibrium, setting, start, velocity);
  const bool is_state = motion.step(1e10, 1e10) == Outcome::converged;
  EXPECT_FALSE(is_state && motion.find_energy());
}

}  // namespace
}  // namespace peristat
