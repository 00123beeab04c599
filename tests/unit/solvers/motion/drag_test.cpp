#include "solvers/motion/drag.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/terms/springs/inertia_term.hpp"
#include "solvers/motion/newmark.hpp"
#include "solvers/motion/velocity_verlet.hpp"
#include "src/core/integral.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

TEST(DragFactors, AreIntegralsOfTheDecay) {
  for (const double x : {1e-12, 1e-5, 0.00999, 0.01, 0.1, 1.0, 30.0}) {
    const DragFactors found(x);
    EXPECT_NEAR(found.decay, std::exp(-x), 1e-15);
    EXPECT_NEAR(found.lost, -std::expm1(-x), 1e-15 * x);
    const auto mean_of = [&](const auto& weight) {
      return integral([&](double s) { return weight(s) * std::exp(-x * s); }, 0.0, 1.0);
    };
    EXPECT_NEAR(found.phi1 / mean_of([](double) { return 1.0; }), 1.0, 2e-13) << x;
    EXPECT_NEAR(found.phi2 / mean_of([](double s) { return 1.0 - s; }), 1.0, 2e-13) << x;
  }
  EXPECT_EQ(DragFactors(0.0).phi2, 0.5);
}

/// A bar in a layer that absorbs. Its points have the mass `mass`.
struct DraggedBar {
  static constexpr double mass = 0.01;

  DraggedBar(double rate, const std::vector<SupportSpecification>& supports,
             const std::vector<LoadSpecification>& loads)
      : body(tests::points_with_ends(tests::small_box(1)), tests::small_box(1)),
        conditions(body.points, supports, loads),
        free(conditions.prescribed(), 1) {
    body.model.add(std::make_shared<InertiaTerm>(body.points));
    assembler.emplace(body.points, body.model, 1);
    tangent.emplace(BlockPattern(body.model.bonds()), 1);
    EXPECT_EQ(solver.analyze(tangent->pattern, free), LinearOutcome::solved);
    setting.mass.assign(body.dofs(), mass);
    setting.absorption.assign(body.dofs(), rate);
  }

  /// @param is_implicit Newmark's method; otherwise Verlet's
  [[nodiscard]] std::unique_ptr<Motion> motion(bool is_implicit, std::vector<double> displacement) {
    const State start{std::move(displacement), 0.0, assembler->initial_history()};
    const EquilibriumProblem problem{*assembler, conditions, free};
    std::vector<double> velocity(body.dofs(), 0.0);
    if (!is_implicit) {
      return std::make_unique<VelocityVerlet>(problem, setting, start, std::move(velocity));
    }
    NewtonOptions options;
    options.relative_tolerance = 1e-13;
    return std::make_unique<Newmark>(problem, setting, start, std::move(velocity),
                                     std::vector<double>(), 1.0,
                                     Newmark::Search{solver, *tangent, options, {}});
  }

  tests::BoxBody body;
  Conditions conditions;
  FreeDofs free;
  std::optional<Assembler> assembler;
  std::optional<Tangent> tangent;
  Cholesky solver;
  MotionSetting setting;
};

/// u = a (t - (1 - e^-eta t)/eta)/eta,   v = a (1 - e^-eta t)/eta,   and the drag takes
/// int eta m v^2 dt = m a u - m v^2/2.
TEST(Drag, OfAFreeBarUnderAConstantAccelerationIsExactForAnyRate) {
  constexpr double force = 10.0, dt = 0.01;
  for (const bool is_implicit : {false, true}) {
    for (const double rate : {1e-3, 10.0, 100.0, 1e3, 1e4}) {
      DraggedBar bar(rate, {}, {tests::body_force("all", "10")});
      const auto motion = bar.motion(is_implicit, std::vector<double>(bar.body.dofs(), 0.0));
      double drained = 0.0, kinetic = 0.0;
      for (int step = 1; step <= 40; ++step) {
        ASSERT_EQ(motion->step(dt, dt * step), Outcome::converged);
        const double x = rate * dt * step, t = dt * step;
        drained = kinetic = 0.0;
        for (Index i = 0; i < bar.body.points.count(); ++i) {
          const double a = force * bar.body.points.volume[i] / DraggedBar::mass;
          const double v = -a * std::expm1(-x) / rate;
          const double u = a * t * t * DragFactors(x).phi2;
          ASSERT_NEAR(motion->at().displacement[i] / u, 1.0, 1e-9) << rate << ' ' << step;
          ASSERT_NEAR(motion->velocity()[i] / v, 1.0, 1e-9) << rate << ' ' << step;
          kinetic += 0.5 * DraggedBar::mass * v * v;
          drained += DraggedBar::mass * (a * u - 0.5 * v * v);
        }
      }
      motion->complete_sums();
      EXPECT_NEAR(motion->sums().absorbed / drained, 1.0, 1e-6 + 1e-9 / rate) << rate;
      ASSERT_TRUE(motion->find_energy());
      EXPECT_NEAR(motion->kinetic_energy() / kinetic, 1.0, 1e-8);
      EXPECT_NEAR(motion->sums().work, kinetic + drained, 1e-9 * motion->sums().work) << rate;
    }
  }
}

/// A point on springs: u = e^(-eta t/2) (cos W t + eta/(2 W) sin W t), W^2 = w^2 - eta^2/4; for
/// large rates W is imaginary.
double damped(double rate, double frequency, double t) {
  const double square = frequency * frequency - 0.25 * rate * rate;
  const double w = std::sqrt(std::abs(square)), half = 0.5 * rate;
  if (square > 0.0) {
    return std::exp(-half * t) * (std::cos(w * t) + half / w * std::sin(w * t));
  }
  const double slow = std::exp((w - half) * t), fast = std::exp(-(w + half) * t);
  return 0.5 * ((1.0 + half / w) * slow + (1.0 - half / w) * fast);
}

TEST(Drag, OfAPointOnSpringsIsOfSecondOrderAndBalances) {
  const std::vector<SupportSpecification> ends{tests::support("left", "0"),
                                               tests::support("right", "0")};
  for (const bool is_implicit : {false, true}) {
    for (const double rate : {0.5, 5.0, 60.0}) {
      DraggedBar bar(rate, ends, {});
      // All but one point are heavy, and stand still.
      const Index moving = bar.free.dof[bar.free.dof.size() / 2];
      for (const Index dof : bar.free.dof) {
        if (dof != moving) bar.setting.mass[dof] = 1e9;
      }
      constexpr double amplitude = 1e-6;
      std::vector<double> start(bar.body.dofs(), 0.0);
      start[moving] = amplitude;
      bar.tangent->linearise(*bar.assembler,
                             {start, bar.assembler->initial_history(), Damage::held}, 0.0);
      const double frequency = std::sqrt(bar.tangent->diagonal[moving] / DraggedBar::mass);
      const double end = 3.0 / frequency;
      double last = 0.0;
      for (const int steps : {40, 80, 160}) {
        const auto motion = bar.motion(is_implicit, start);
        ASSERT_TRUE(motion->find_energy());
        const double dt = end / steps, before = motion->at().stored_energy;
        const double of_scheme = motion->scheme_energy(dt);
        double absorbed = 0.0;
        for (int step = 1; step <= steps; ++step) {
          ASSERT_EQ(motion->step(dt, dt * step), Outcome::converged);
          EXPECT_GE(motion->sums().absorbed, absorbed);
          absorbed = motion->sums().absorbed;
        }
        motion->complete_sums();
        ASSERT_TRUE(motion->find_energy());
        const double now = motion->at().stored_energy + motion->kinetic_energy();
        EXPECT_NEAR(now + absorbed, before + motion->sums().correction, 1e-7 * before) << rate;
        EXPECT_NEAR(motion->sums().correction, motion->scheme_energy(dt) - of_scheme,
                    1e-12 * before);
        const double error =
            std::abs(motion->at().displacement[moving] - amplitude * damped(rate, frequency, end));
        if (last > 0.0) {
          EXPECT_NEAR(last / error, 4.0, 0.4) << rate << ' ' << is_implicit;
        }
        last = error;
      }
    }
  }
}

}  // namespace
}  // namespace peristat
