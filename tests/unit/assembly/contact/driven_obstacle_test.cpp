// Obstacles that a force drives: where they are, and what their motion adds to energies, forces and
// tangents.

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/contact/obstacle_term.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::BoxSetting;
using tests::norm;
using tests::Random;

using Kind = RigidSurface::Kind;

/// Lengths [m], and E [Pa].
constexpr double spacing = 0.1, modulus = 3.0, section = 0.5;

/// The points of a box, which nothing but obstacles hold.
struct Driven {
  BoxBody body;
  Obstacles obstacles;
  Model model;
  Assembler assembler;

  Driven(int dimension, const std::vector<ObstacleSpecification>& of)
      : body(box_in(dimension)),
        obstacles(body.points, of, {"load"},
                  {dimension == 3 ? 1.0 : section,
                   std::vector<double>(std::size_t(body.points.count()), modulus)},
                  sole_rank()),
        model(with_obstacles(body, obstacles)),
        assembler(body.points, model, 1) {}

  static BoxSetting box_in(int dimension) {
    BoxSetting box;
    box.dimension = dimension;
    box.extent = {5, dimension > 1 ? 4 : 1, dimension > 2 ? 3 : 1};
    box.spacing = spacing;
    box.cross_section = dimension == 3 ? 1.0 : section;
    box.youngs_modulus = modulus;
    return box;
  }
  static Model with_obstacles(const BoxBody& body, const Obstacles& obstacles) {
    Model model(body.model.bonds());
    model.add(std::make_shared<ObstacleTerm>(body.points, obstacles));
    return model;
  }

  [[nodiscard]] SharedEnvironment under(double load) const {
    auto made = std::make_shared<Environment>();
    made->obstacles = obstacles.displacements(std::vector<double>{load});
    return made;
  }
  /// Towards the obstacles, nearly uniformly, and as much as they are pressed.
  [[nodiscard]] std::vector<double> pressed_state() const {
    const auto d = std::size_t(body.points.dimension);
    std::vector<double> u = Random(7).vector(body.dofs(), 0.01 * spacing);
    for (std::size_t k = 0; k < u.size(); k += d) u[k] -= 0.04 * spacing;
    return u;
  }
};

/// Obstacles that touch the side x- of the box, whose surface is at x = 0, at its middle, and move
/// by 3 mm towards it.
std::vector<ObstacleSpecification> moved_obstacles(int dimension) {
  const double y = dimension > 1 ? 0.15 : 0.0, z = dimension > 2 ? 0.15 : 0.0;
  ObstacleSpecification plane{.name = "plane"};
  plane.surface = {Kind::plane, {0.0, y, z}, {2.0, 0.0, 0.0}};
  ObstacleSpecification slope{.name = "slope"};
  slope.surface = {Kind::plane, {0.0008, 0.0, z}, {1.0, 0.02, 0.0}};
  const Coordinates axis = unit(Coordinates{0.0, dimension > 2 ? 0.3 : 0.0, 1.0});
  ObstacleSpecification cylinder{.name = "cylinder"};
  cylinder.surface = {Kind::cylinder, {-4.0, y, z}, axis, 4.0};
  ObstacleSpecification pipe{.name = "pipe"};
  const double reach = std::sqrt(0.95 * 0.95 - 0.15 * 0.15);
  pipe.surface = {Kind::cylinder, {0.05 + reach, 0.2, z}, {0.0, 0.0, 1.0}, 1.0, true};
  ObstacleSpecification ball{.name = "ball"};
  ball.surface = {Kind::sphere, {-4.0, y, z}, {}, 4.0};
  std::vector<ObstacleSpecification> all{plane};
  if (dimension > 1) all.insert(all.end(), {slope, cylinder, pipe});
  if (dimension > 2) all.push_back(ball);
  for (ObstacleSpecification& of : all) of.displacement = {"3e-3", "0", "0"};
  return all;
}

ObstacleSpecification driven_by(ObstacleSpecification of, double force) {
  of.displacement[0] = "free";
  of.force = number_text(force) + "*load";
  return of;
}

/// The force of an obstacle that moves by 3 mm.
double force_of(const ObstacleSpecification& of, int dimension) {
  const Driven moved(dimension, {of});
  return moved.obstacles.actions(moved.pressed_state(), moved.under(1.0), {}).at(of.name).force[0];
}

struct DrivenObstacles : testing::TestWithParam<int> {};

TEST_P(DrivenObstacles, IsWhereItsForceComesFrom) {
  for (const ObstacleSpecification& of : moved_obstacles(GetParam())) {
    SCOPED_TRACE(of.name);
    const double force = force_of(of, GetParam());
    ASSERT_GT(force, 0.0);
    const Driven driven(GetParam(), {driven_by(of, force)});
    const std::vector<double> u = driven.pressed_state();
    const auto action = driven.obstacles.actions(u, driven.under(1.0), {}).at(of.name);
    EXPECT_NEAR(action.displacement[0], 3e-3, 1e-14);
    EXPECT_NEAR(action.force[0], force, 1e-12 * force);
    for (const double share : {1e-12, 1e-6, 0.1, 10.0}) {
      const auto borne = driven.obstacles.actions(u, driven.under(share), {}).at(of.name);
      EXPECT_NEAR(borne.force[0], share * force, 1e-11 * std::max(share, 1.0) * force) << share;
    }
  }
}

TEST_P(DrivenObstacles, GradientIsDerivativeOfEnergyAndHessianOfGradient) {
  for (const ObstacleSpecification& of : moved_obstacles(GetParam())) {
    SCOPED_TRACE(of.name);
    Driven driven(GetParam(), {driven_by(of, force_of(of, GetParam()))});
    const SharedEnvironment environment = driven.under(1.0);
    const std::vector<double> u = driven.pressed_state(), v = Random(3).vector(u.size());
    const History none;
    struct At {
      double energy;
      std::vector<double> gradient;
    };
    const auto at = [&](double by) {
      std::vector<double> place = u;
      for (std::size_t k = 0; k < place.size(); ++k) place[k] += by * v[k];
      At found{0.0, std::vector<double>(u.size())};
      const Evaluation of_state =
          driven.assembler.gradient({place, none, Damage::grows, environment}, found.gradient);
      EXPECT_FALSE(of_state.degenerate);
      found.energy = of_state.energy + driven.obstacles.potential(place, environment);
      return found;
    };
    const At here = at(0.0);
    // A single contact has no stiffness: the obstacle follows its point.
    const double whole = driven.obstacles.contacts()[0].stiffness * norm(v);
    constexpr double h = 2e-4 * spacing;
    const At ahead = at(h), behind = at(-h), far_ahead = at(2 * h), far_behind = at(-2 * h);
    const double slope =
        (8.0 * (ahead.energy - behind.energy) - (far_ahead.energy - far_behind.energy)) /
        (12.0 * h);
    EXPECT_NEAR(slope, tests::dot(here.gradient, v), 1e-8 * norm(here.gradient) * norm(v));
    std::vector<double> image(u.size()), difference(u.size());
    for (std::size_t k = 0; k < u.size(); ++k) {
      difference[k] = (8.0 * (ahead.gradient[k] - behind.gradient[k]) -
                       (far_ahead.gradient[k] - far_behind.gradient[k])) /
                      (12.0 * h);
    }
    const StateView view(u, none, Damage::grows, environment);
    if (GetParam() > 1) {
      ASSERT_GT(driven.assembler.closed_contacts(view).size(), 1U);
    }
    driven.assembler.product(view, v, image);
    EXPECT_LE(tests::distance(difference, image), 1e-8 * norm(image) + 1e-12 * whole);
    Tangent tangent(driven.assembler);
    std::vector<double> stored(u.size());
    for (const double projection : {0.0, 0.7, 1.0}) {
      tangent.linearise(driven.assembler, view, projection);
      tangent.multiply(v, stored);
      driven.assembler.product(view, v, image, projection);
      EXPECT_LE(tests::distance(stored, image), 1e-15 * whole) << projection;
    }
    EXPECT_GE(tests::dot(v, stored), -1e-15 * whole * norm(v));  // projected
    // A body that moves along the axis takes the obstacle with it.
    std::vector<double> along(u.size(), 0.0);
    for (std::size_t k = 0; k < u.size(); k += std::size_t(GetParam())) along[k] = 1.0;
    driven.assembler.product(view, along, image);
    driven.assembler.product(view, v, stored);
    EXPECT_LE(norm(image), 1e-14 * whole);
  }
}

TEST_P(DrivenObstacles, ForeseenSpringsBearTheForceAndAreALinearProblem) {
  for (const ObstacleSpecification& of : moved_obstacles(GetParam())) {
    SCOPED_TRACE(of.name);
    const double force = force_of(of, GetParam());
    Driven driven(GetParam(), {driven_by(of, force)});
    const std::vector<double> rest(driven.body.dofs(), 0.0), pressed = driven.pressed_state();
    const History none;
    StateView view(rest, none, Damage::grows, driven.under(1.0));
    view.foreseen = pressed;
    std::vector<double> gradient(rest.size());
    EXPECT_FALSE(driven.assembler.closed_contacts(view).empty());
    EXPECT_FALSE(driven.assembler.gradient(view, gradient).degenerate);
    double sum = 0.0;
    for (std::size_t k = 0; k < gradient.size(); k += std::size_t(GetParam())) sum -= gradient[k];
    EXPECT_NEAR(sum, force, 1e-12 * force);
  }
}

TEST_P(DrivenObstacles, WithoutAForceItGivesWay) {
  ObstacleSpecification of = moved_obstacles(GetParam())[0];
  of.surface.point[0] = -0.02;
  Driven driven(GetParam(), {driven_by(of, 1.0)});
  const auto at = [&](double along, double load) {
    std::vector<double> u(driven.body.dofs(), 0.0), gradient(u.size());
    for (std::size_t k = 0; k < u.size(); k += std::size_t(GetParam())) u[k] = along;
    const History none;
    const StateView view(u, none, Damage::grows, driven.under(load));
    EXPECT_FALSE(driven.assembler.gradient(view, gradient).degenerate);
    if (load == 0.0) {
      EXPECT_EQ(norm(gradient), 0.0);
      EXPECT_TRUE(driven.assembler.closed_contacts(view).empty());
    }
    return driven.obstacles.actions(u, view.environment, {}).at(of.name).displacement[0];
  };
  EXPECT_EQ(at(0.0, 0.0), 0.0);              // at its start
  EXPECT_EQ(at(-0.01, 0.0), 0.0);            // not reached yet
  EXPECT_NEAR(at(-0.5, 0.0), -0.48, 1e-15);  // pushed back
  EXPECT_NEAR(at(0.5, 1e-9), 0.52, 1e-6);    // with a force it follows
  EXPECT_NEAR(at(-0.5, 1e-9), -0.48, 1e-6);
}

TEST_P(DrivenObstacles, AForceThatNothingBearsIsNoticed) {
  for (const ObstacleSpecification& of : moved_obstacles(GetParam())) {
    SCOPED_TRACE(of.name);
    const bool is_two_sided = of.name == "pipe";
    Driven driven(GetParam(), {driven_by(of, -1.0)});
    const std::vector<double> u = driven.pressed_state();
    std::vector<double> gradient(u.size());
    const History none;
    const auto refuses = [&](double load) {
      try {
        driven.obstacles.refuse_idle_forces(driven.under(load));
      } catch (const InputError& error) {
        return error.key() == "obstacles[0].force";
      }
      return false;
    };
    EXPECT_EQ(refuses(1.0), !is_two_sided);
    EXPECT_FALSE(refuses(0.0));
    EXPECT_FALSE(refuses(-1.0));
    if (is_two_sided) continue;
    EXPECT_TRUE(driven.assembler.gradient({u, none, Damage::grows, driven.under(1.0)}, gradient)
                    .degenerate);
    // More than the law gives at the largest depth.
    EXPECT_TRUE(driven.assembler.gradient({u, none, Damage::grows, driven.under(-1e9)}, gradient)
                    .degenerate);
  }
}

INSTANTIATE_TEST_SUITE_P(InDimension, DrivenObstacles, testing::Values(1, 2, 3));

TEST(DrivenObstacle, PipeIsPushedToEitherSideAndSqueezed) {
  ObstacleSpecification pipe{.name = "pipe"};
  pipe.surface = {Kind::cylinder, {0.25, 0.2, 0.0}, {0.0, 0.0, 1.0}, 0.4, true};
  Driven driven(2, {driven_by(pipe, 1e-3)});
  const auto at = [&](double stretch, double load) {
    std::vector<double> u(driven.body.dofs(), 0.0);
    for (std::size_t k = 0; k < u.size(); k += 2) {
      u[k] = stretch * (driven.body.points.reference[k] - 0.25);
    }
    return driven.obstacles.actions(u, driven.under(load), {}).at("pipe");
  };
  const double to_one = at(0.0, 1.0).displacement[0], to_other = at(0.0, -1.0).displacement[0];
  EXPECT_GT(to_one, 0.0);
  EXPECT_NEAR(to_other, -to_one, 1e-12);
  EXPECT_EQ(at(0.0, 0.0).displacement[0], 0.0);
  EXPECT_EQ(at(0.0, 0.0).force[0], 0.0);
  // Larger than the pipe: both sides press, and without a force as much.
  const auto squeezed = at(0.6, 0.0);
  EXPECT_NEAR(squeezed.displacement[0], 0.0, 1e-12);
  EXPECT_NEAR(squeezed.force[0], 0.0, 1e-12);
  EXPECT_NEAR(at(0.6, 1.0).force[0], 1e-3, 1e-12);
  EXPECT_GT(at(0.6, 1.0).displacement[0], 0.0);
}

/// Springs in a line: the work of a force is the energy that they store.
TEST(DrivenObstacle, WorkBeginsAndEndsWithContact) {
  ObstacleSpecification of = moved_obstacles(1)[0];
  of.surface.point[0] = -0.02;
  const Driven driven(1, {driven_by(of, 2.0)});
  const std::vector<double> rest(driven.body.dofs(), 0.0);
  std::vector<double> pressed = rest;
  pressed[0] = 0.01;
  const auto work = [&](const std::vector<double>& from, double load_from,
                        const std::vector<double>& to, double load_to) {
    return driven.obstacles.work(from, driven.under(load_from), {}, to, driven.under(load_to), {});
  };
  const auto place = [&](const std::vector<double>& u, double load) {
    return driven.obstacles.actions(u, driven.under(load), {}).at("plane").displacement[0];
  };
  const double way = place(pressed, 1.0) - 0.02;  // from where the points stand at rest
  ASSERT_GT(way, 0.01);
  EXPECT_NEAR(work(rest, 0.0, pressed, 1.0), 0.5 * 2.0 * way, 1e-12);
  EXPECT_NEAR(work(pressed, 1.0, rest, 0.0), -0.5 * 2.0 * way, 1e-12);
  EXPECT_NEAR(work(rest, 1.0, pressed, 1.0), 2.0 * 0.01, 1e-12);  // under a constant force
  EXPECT_EQ(work(rest, 0.0, pressed, 0.0), 0.0);
}

TEST(DrivenObstacle, BadOnesAreRefused) {
  const auto key = [](int dimension, std::size_t which, auto change) -> std::string {
    ObstacleSpecification of = driven_by(moved_obstacles(dimension)[which], 1.0);
    change(of);
    try {
      static_cast<void>(Driven(dimension, {of}).under(1.0));
    } catch (const InputError& error) {
      return error.key();
    }
    return "nothing";
  };
  EXPECT_EQ(key(2, 0, [](auto&) {}), "nothing");
  EXPECT_EQ(key(2, 0, [](auto& of) { of.force = ""; }), "obstacles[0].displacement[0]");
  EXPECT_EQ(key(2, 0, [](auto& of) { of.displacement[0] = "0"; }), "obstacles[0].force");
  EXPECT_EQ(key(2, 0, [](auto& of) { of.displacement[1] = "free"; }),
            "obstacles[0].displacement[1]");
  EXPECT_EQ(key(2, 0,
                [](auto& of) {
                  of.displacement = {"0", "free", "0"};
                }),
            "obstacles[0].force");  // along the plane
  EXPECT_EQ(key(3, 2,
                [](auto& of) {
                  of.displacement = {"0", "0", "free"};
                  of.surface.direction = {0.0, 0.0, 1.0};
                }),
            "obstacles[0].force");  // along the axis
  EXPECT_EQ(key(2, 0, [](auto& of) { of.friction = 0.1; }), "obstacles[0].force");
  EXPECT_EQ(key(2, 0, [](auto& of) { of.force = "1*y"; }), "obstacles[0].force");
  EXPECT_EQ(key(2, 0, [](auto& of) { of.force = "1/0"; }), "obstacles[0].force");
  EXPECT_EQ(key(2, 0, [](auto& of) { of.force = "1/(load-1)"; }), "obstacles[0].force");
}

}  // namespace
}  // namespace peristat
