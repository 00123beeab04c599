#include "assembly/terms/contact/obstacle_term.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
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

/// The points of a box without bonds, and one obstacle in front of them.
struct Pressed {
  BoxBody body;
  Obstacles obstacles;
  Model model;
  Assembler assembler;

  Pressed(const BoxSetting& box, const ObstacleSpecification& of)
      : body(box),
        obstacles(
            body.points, {of}, {"load"},
            {box.cross_section, std::vector<double>(std::size_t(body.points.count()), modulus)},
            sole_rank()),
        model(with_obstacles(body, obstacles)),
        assembler(body.points, model, 1) {}

  static Model with_obstacles(const BoxBody& body, const Obstacles& obstacles) {
    Model model(body.model.bonds());
    model.add(std::make_shared<ObstacleTerm>(body.points, obstacles));
    return model;
  }
};

BoxSetting box_in(int dimension) {
  BoxSetting box;
  box.dimension = dimension;
  box.extent = {5, dimension > 1 ? 4 : 1, dimension > 2 ? 3 : 1};
  box.spacing = spacing;
  box.cross_section = dimension == 3 ? 1.0 : section;
  box.youngs_modulus = modulus;
  return box;
}

/// Obstacles that touch the side x- of the box, whose surface is at x = 0, at its middle.
std::vector<ObstacleSpecification> obstacles_in(int dimension) {
  const double y = dimension > 1 ? 0.15 : 0.0, z = dimension > 2 ? 0.15 : 0.0;
  ObstacleSpecification plane{.name = "plane"};
  plane.surface = {Kind::plane, {0.0, y, z}, {2.0, 0.0, 0.0}};
  std::vector<ObstacleSpecification> all{plane};
  const Coordinates axis = unit(Coordinates{0.0, dimension > 2 ? 0.3 : 0.0, 1.0});
  ObstacleSpecification cylinder{.name = "cylinder"};
  cylinder.surface = {Kind::cylinder, {-0.4, y, z}, axis, 0.4};
  if (dimension > 1) all.push_back(cylinder);
  ObstacleSpecification pipe{.name = "pipe"};
  // Touches at the row that is two spacings aside: (R - d)^2 = x^2 + (2 spacings)^2.
  const double reach = std::sqrt(0.95 * 0.95 - 0.2 * 0.2);
  pipe.surface = {Kind::cylinder, {0.05 + reach, y, z}, {0.0, 0.0, 1.0}, 1.0, true};
  if (dimension > 1) all.push_back(pipe);
  ObstacleSpecification ball{.name = "ball"};
  ball.surface = {Kind::sphere, {-0.4, y, z}, {}, 0.4};
  if (dimension > 2) all.push_back(ball);
  for (ObstacleSpecification& of : all) of.displacement = {"0.01*load", "0", "0"};
  return all;
}

/// Nearly uniform strains of a tenth of the spacing, towards the obstacle.
std::vector<double> pressed_state(const Pressed& pressed) {
  const int d = pressed.body.points.dimension;
  std::vector<double> u = Random(7).vector(pressed.body.dofs(), 0.01 * spacing);
  for (std::size_t k = 0; k < u.size(); k += std::size_t(d)) u[k] -= 0.04 * spacing;
  return u;
}

SharedEnvironment moved_by(const Obstacles& obstacles, double load) {
  auto made = std::make_shared<Environment>();
  made->obstacles = obstacles.displacements(std::vector<double>{load});
  return made;
}

struct ObstacleTerms : testing::TestWithParam<int> {};

TEST_P(ObstacleTerms, GradientIsDerivativeOfEnergyAndHessianOfGradient) {
  for (const ObstacleSpecification& of : obstacles_in(GetParam())) {
    SCOPED_TRACE(of.name);
    Pressed pressed(box_in(GetParam()), of);
    const SharedEnvironment environment = moved_by(pressed.obstacles, 0.3);
    const std::vector<double> u = pressed_state(pressed);
    const std::vector<double> v = Random(3).vector(u.size());
    const History none;
    const auto view = [&](const std::vector<double>& at) {
      return StateView(at, none, Damage::grows, environment);
    };
    const auto shifted = [&](double by) {
      std::vector<double> at = u;
      for (std::size_t k = 0; k < at.size(); ++k) at[k] += by * v[k];
      return at;
    };
    struct At {
      double energy;
      std::vector<double> gradient;
    };
    const auto at = [&](double by) {
      At found{0.0, std::vector<double>(u.size())};
      found.energy = pressed.assembler.gradient(view(shifted(by)), found.gradient).energy;
      return found;
    };
    const At here = at(0.0);
    ASSERT_GT(norm(here.gradient), 0.0);
    // Differences of fourth order, whose error is of the order 1e-10 here.
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
    pressed.assembler.product(view(u), v, image);
    EXPECT_LT(tests::distance(difference, image), 1e-8 * norm(image));
    Tangent tangent(pressed.assembler);
    std::vector<double> stored(u.size());
    for (const double projection : {0.0, 0.7, 1.0}) {
      tangent.linearise(pressed.assembler, view(u), projection);
      tangent.multiply(v, stored);
      pressed.assembler.product(view(u), v, image, projection);
      EXPECT_LT(tests::distance(stored, image), 1e-14 * norm(image)) << projection;
    }
    EXPECT_GE(tests::dot(v, stored), 0.0);  // projected
    std::vector<double> energies(std::size_t(pressed.body.points.count()));
    pressed.assembler.point_energies(view(u), energies);
    double sum = 0.0;
    for (const double energy : energies) sum += energy;
    EXPECT_NEAR(sum, here.energy, 1e-14 * here.energy);
  }
}

TEST_P(ObstacleTerms, ReactionAndMomentAreThoseOfTheForcesOnPoints) {
  for (const ObstacleSpecification& of : obstacles_in(GetParam())) {
    SCOPED_TRACE(of.name);
    Pressed pressed(box_in(GetParam()), of);
    const SharedEnvironment environment = moved_by(pressed.obstacles, 0.3);
    const std::vector<double> u = pressed_state(pressed);
    std::vector<double> gradient(u.size()), force(u.size(), 0.0);
    static_cast<void>(
        pressed.assembler.gradient({u, History(), Damage::grows, environment}, gradient));
    pressed.obstacles.add_force(u, environment, {}, 1.0, force);
    const Obstacles::Action action = pressed.obstacles.actions(u, environment, {}).at(of.name);
    EXPECT_DOUBLE_EQ(action.displacement[0], 0.003);
    Coordinates total{}, moment{};
    const auto d = std::size_t(GetParam());
    for (Index i = 0; i < pressed.body.points.count(); ++i) {
      Coordinates own{}, arm = minus(pressed.body.points.position(i), of.surface.point);
      for (std::size_t c = 0; c < d; ++c) {
        const std::size_t dof = std::size_t(i) * d + c;
        EXPECT_EQ(force[dof], -gradient[dof]);
        own[c] = -gradient[dof];
        arm[c] += u[dof] - action.displacement[c];
      }
      total = plus(total, own);
      moment = plus(moment, cross(arm, own));
    }
    EXPECT_GT(total[0], 0.0);  // away from the obstacle
    EXPECT_LT(length(minus(total, action.force)), 1e-14 * length(total));
    EXPECT_LT(length(minus(moment, action.moment)), 1e-14 * length(total));
    // A round surface without friction turns about its axis or centre without any effort.
    const double about_axis = dot(action.moment, of.surface.direction);
    const double about_centre = length(action.moment), round_off = 1e-14 * length(total);
    if (of.surface.kind == Kind::cylinder) {
      EXPECT_NEAR(about_axis, 0.0, round_off);
    }
    if (of.surface.kind == Kind::sphere) {
      EXPECT_LT(about_centre, round_off);
    }
  }
}

TEST_P(ObstacleTerms, StepEndsBeforeTheLargestDepth) {
  for (const ObstacleSpecification& of : obstacles_in(GetParam())) {
    SCOPED_TRACE(of.name);
    Pressed pressed(box_in(GetParam()), of);
    std::vector<double> u(pressed.body.dofs(), 0.0), step(u.size(), 0.0);
    for (std::size_t k = 0; k < u.size(); k += std::size_t(GetParam())) step[k] = -spacing;
    const History none;
    const StateView at(u, none);
    const double share = pressed.assembler.longest_step(at, step);
    ASSERT_GT(share, 0.0);
    ASSERT_LT(share, 0.25);
    std::vector<double> there(u.size()), gradient(u.size());
    const auto moved = [&](double by) {
      for (std::size_t k = 0; k < u.size(); ++k) there[k] = by * step[k];
      return pressed.assembler.gradient({there, none}, gradient);
    };
    EXPECT_FALSE(moved(share).degenerate);
    EXPECT_FALSE(moved(share / 0.81 * 0.99).degenerate);  // 0.9 of the way to 0.9 of the depth
    EXPECT_TRUE(moved(share / 0.81 * 1.01).degenerate);
    // What moves away, and a step that ends before, is not shortened.
    std::vector<double> away = step;
    for (double& entry : away) entry = -entry;
    EXPECT_EQ(pressed.assembler.longest_step(at, away), 1.0);
    for (double& entry : step) entry *= 0.9 * share;
    EXPECT_EQ(pressed.assembler.longest_step(at, step), 1.0);
  }
}

TEST_P(ObstacleTerms, ForeseenContactsAreSpringsThatAlsoPull) {
  for (const ObstacleSpecification& of : obstacles_in(GetParam())) {
    SCOPED_TRACE(of.name);
    Pressed pressed(box_in(GetParam()), of);
    std::vector<double> open(pressed.body.dofs(), 0.0), closed = open, gradient(open.size());
    const auto d = std::size_t(GetParam());
    for (std::size_t k = 0; k < open.size(); k += d) open[k] = 1e-3, closed[k] = -1e-3;
    const History none;
    StateView view(open, none);
    EXPECT_EQ(pressed.assembler.gradient(view, gradient).energy, 0.0);
    view.foreseen = open;
    EXPECT_TRUE(pressed.assembler.closed_contacts(view).empty());
    view.foreseen = closed;
    const std::vector<Index> contacts = pressed.assembler.closed_contacts(view);
    ASSERT_FALSE(contacts.empty());
    const double energy = pressed.assembler.gradient(view, gradient).energy;
    EXPECT_GT(energy, 0.0);
    double pull = 0.0, expected = 0.0, stored = 0.0;
    for (const Index contact : contacts) {
      const Obstacles::Contact& one = pressed.obstacles.contacts()[std::size_t(contact)];
      Coordinates place = pressed.body.points.position(one.point);
      place[0] += 1e-3;
      const Coordinates start = minus(pressed.body.points.position(one.point), of.surface.point);
      const RigidSurface& surface = pressed.obstacles.all()[0].surface;
      const auto change = surface.change(start, {1e-3, 0.0, 0.0});
      const double gap = one.gap + change.value;
      EXPECT_NEAR(surface.distance(minus(place, of.surface.point)), gap + 0.5 * spacing, 1e-15);
      expected += one.stiffness * gap * change.gradient[0];
      stored += 0.5 * one.stiffness * gap * gap;
      pull += gradient[std::size_t(one.point) * d];
    }
    EXPECT_NEAR(pull, expected, 1e-12 * std::abs(expected));
    EXPECT_NEAR(energy, stored, 1e-12 * stored);
  }
}

INSTANTIATE_TEST_SUITE_P(InDimension, ObstacleTerms, testing::Values(1, 2, 3));

TEST(Obstacles, StiffnessIsThatOfTheCellsOverHalfASpacing) {
  const double of_section[] = {section, section * spacing, spacing * spacing};
  for (const int d : {1, 2, 3}) {
    ObstacleSpecification of = obstacles_in(d).front();
    of.stiffness = 2.0;
    const Pressed pressed(box_in(d), of);
    for (const Obstacles::Contact& contact : pressed.obstacles.contacts()) {
      EXPECT_DOUBLE_EQ(contact.distance, 0.5 * spacing);
      EXPECT_DOUBLE_EQ(contact.stiffness, 2.0 * modulus * of_section[d - 1] / (0.5 * spacing));
    }
  }
}

TEST(Obstacles, APassedCylinderIsNoticedAndOneThatRollsByIsNot) {
  ObstacleSpecification of = obstacles_in(2)[1];
  of.displacement = {"load", "0", "0"};
  Pressed pressed(box_in(2), of);
  const std::vector<double> u(pressed.body.dofs(), 0.0);
  const History none;
  const auto passes = [&](double from, double to) {
    return pressed.assembler.has_passed({u, none, Damage::grows, moved_by(pressed.obstacles, from)},
                                        {u, none, Damage::grows, moved_by(pressed.obstacles, to)});
  };
  EXPECT_FALSE(passes(0.0, 0.01));
  EXPECT_FALSE(passes(0.0, 0.2));  // pressed deep, but nothing is behind its axis
  EXPECT_TRUE(passes(0.0, 2.0));
  EXPECT_TRUE(passes(2.0, 0.0));
  of.displacement = {"0", "load", "0"};
  Pressed sliding(box_in(2), of);
  EXPECT_FALSE(
      sliding.assembler.has_passed({u, none, Damage::grows, moved_by(sliding.obstacles, -1.0)},
                                   {u, none, Damage::grows, moved_by(sliding.obstacles, 1.0)}));
}

std::string refused(const ObstacleSpecification& of, int dimension = 2) {
  try {
    Pressed(box_in(dimension), of).obstacles.refuse_overlap(sole_rank());
  } catch (const InputError& error) {
    return error.key();
  }
  return "nothing";
}

TEST(Obstacles, BadOnesAreRefused) {
  const ObstacleSpecification plane = obstacles_in(2)[0], cylinder = obstacles_in(2)[1];
  EXPECT_EQ(refused(plane), "nothing");
  EXPECT_EQ(refused(cylinder), "nothing");
  const auto with = [](ObstacleSpecification of, auto change) {
    change(of);
    return of;
  };
  const auto key = [&](const ObstacleSpecification& like, auto change) {
    return refused(with(like, change));
  };
  EXPECT_EQ(key(plane, [](auto& of) { of.surface.direction = {}; }), "obstacles[0].normal");
  EXPECT_EQ(key(plane, [](auto& of) { of.depth = 1.0; }), "obstacles[0].depth");
  EXPECT_EQ(key(plane, [](auto& of) { of.softness = of.depth; }), "obstacles[0].softness");
  EXPECT_EQ(key(plane, [](auto& of) { of.softness = 0.0; }), "obstacles[0].softness");
  EXPECT_EQ(key(plane, [](auto& of) { of.stiffness = 0.0; }), "obstacles[0].stiffness");
  EXPECT_EQ(key(plane, [](auto& of) { of.set = "none"; }), "obstacles[0].set");
  EXPECT_EQ(key(plane, [](auto& of) { of.displacement[0] = "x"; }), "obstacles[0].displacement[0]");
  EXPECT_EQ(key(plane, [](auto& of) { of.surface.point[0] = 1e-6 * spacing; }), "obstacles[0]");
  EXPECT_EQ(key(plane, [](auto& of) { of.surface.point[0] = 1e-14 * spacing; }), "nothing");
  EXPECT_EQ(key(cylinder, [](auto& of) { of.surface.radius = 1.9 * spacing; }),
            "obstacles[0].radius");
  EXPECT_EQ(key(cylinder, [](auto& of) { of.surface.kind = Kind::sphere; }), "obstacles[0].shape");
  EXPECT_EQ(refused(cylinder, 1), "obstacles[0].shape");
}

}  // namespace
}  // namespace peristat
