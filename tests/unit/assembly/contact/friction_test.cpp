// Coulomb friction of obstacles: derivatives, what a commit leaves, and what it dissipates.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/contact/obstacle_term.hpp"
#include "tests/bodies.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

using tests::BoxSetting;
using tests::dot;
using tests::norm;
using tests::Random;

constexpr double spacing = 0.1, modulus = 3.0, coefficient = 0.4;

/// Points without bonds on a plane at x = 0.
struct OnPlane {
  Points points;
  Obstacles obstacles;
  Model model;
  Assembler assembler;

  explicit OnPlane(int dimension)
      : points(tests::box_points(box(dimension))),
        obstacles(points, {specification()}, {"load"},
                  {box(dimension).cross_section,
                   std::vector<double>(std::size_t(points.count()), modulus)},
                  sole_rank()),
        model(model_of(points, obstacles)),
        assembler(points, model, 1) {}

  static BoxSetting box(int dimension) {
    BoxSetting setting = tests::small_box(dimension);
    setting.extent = {2, 3, dimension > 2 ? 2 : 0};
    return setting;
  }
  static ObstacleSpecification specification() {
    ObstacleSpecification of{.name = "plane"};
    of.surface = {RigidSurface::Kind::plane, {}, {1.0, 0.0, 0.0}};
    of.friction = coefficient;
    return of;
  }
  static Model model_of(const Points& points, const Obstacles& obstacles) {
    Model model(Bonds{std::vector<Offset>(std::size_t(points.count()) + 1, 0), {}, {}});
    model.add(std::make_shared<ObstacleTerm>(points, obstacles));
    return model;
  }

  /// All points move by this along x and along y.
  [[nodiscard]] std::vector<double> moved(double down, double aside) const {
    std::vector<double> u(points.reference.size());
    const auto d = std::size_t(points.dimension);
    for (std::size_t k = 0; k < u.size(); k += d) {
      u[k] = -down * spacing;
      u[k + 1] = aside * spacing;
    }
    return u;
  }
  /// The history of a search that has gone from one state to another.
  [[nodiscard]] History lagged(const std::vector<double>& from, const std::vector<double>& to,
                               const History& before) {
    History history = before;
    static_cast<void>(
        assembler.lag_friction(StateView(to, before), StateView(from, before), history));
    return history;
  }
  /// Sum of the forces on the points.
  [[nodiscard]] Coordinates force(const std::vector<double>& at, const History& history) {
    std::vector<double> gradient(at.size());
    static_cast<void>(assembler.gradient({at, history}, gradient));
    Coordinates sum{};
    for (std::size_t k = 0; k < gradient.size(); ++k) {
      sum[k % std::size_t(points.dimension)] -= gradient[k];
    }
    return sum;
  }
};

class Friction : public ::testing::TestWithParam<int> {};

TEST_P(Friction, TangentIsTheSecondDerivativeWhereItSticksAndWhereItSlides) {
  OnPlane on(GetParam());
  const std::vector<double> rest(on.points.reference.size()), pressed = on.moved(0.05, 0.0);
  const History history = on.lagged(rest, pressed, {});
  for (const double aside : {0.004, 0.3}) {
    const std::vector<double> at = on.moved(0.04, aside);
    const std::vector<double> v = Random(5).vector(at.size());
    const auto shifted = [&](double t) {
      std::vector<double> there = at;
      for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
      return there;
    };
    std::vector<double> gradient(at.size()), product(at.size()), stored(at.size());
    static_cast<void>(on.assembler.gradient({at, history}, gradient));
    on.assembler.product({at, history}, v, product);
    const auto energy = [&](double t) {
      return std::vector{on.assembler.energy({shifted(t), history}).energy};
    };
    const auto forces = [&](double t) {
      std::vector<double> there(at.size());
      static_cast<void>(on.assembler.gradient({shifted(t), history}, there));
      return there;
    };
    EXPECT_TRUE(tests::is_derivative(energy, {dot(gradient, v)}, 1e-4 * spacing));
    EXPECT_TRUE(tests::is_derivative(forces, product, 1e-4 * spacing));
    Tangent tangent(on.assembler);
    tangent.linearise(on.assembler, {at, history}, 0.0);
    tangent.multiply(v, stored);
    EXPECT_LE(tests::distance(stored, product), 1e-13 * norm(product));
    // What replaces the exact tangent where all points slide is no less, and definite along them.
    std::vector<double> along = on.moved(0.0, 1.0), projected(at.size());
    on.assembler.product({at, history}, along, projected, 1.0);
    on.assembler.product({at, history}, along, product, 0.0);
    EXPECT_GT(dot(projected, along), 0.0);
    EXPECT_GE(dot(projected, along), dot(product, along) * (1.0 - 1e-12));
  }
}

/// Coulomb: k_t times the displacement up to mu times the normal force, and no more.
TEST_P(Friction, SticksUpToItsLimitAndSlidesBeyond) {
  OnPlane on(GetParam());
  const std::vector<double> rest(on.points.reference.size());
  for (const double aside : {0.001, 0.01, 0.2, -0.2}) {
    const std::vector<double> at = on.moved(0.05, aside);
    const History history = on.lagged(rest, at, {});
    const Coordinates force = on.force(at, history);
    const double rows = GetParam() == 3 ? 6.0 : 3.0, cell = GetParam() == 3 ? 0.01 : 0.05;
    const double stick = rows * 0.5 * modulus * cell / (0.5 * spacing) * aside * spacing;
    const double limit = coefficient * force[0];
    EXPECT_NEAR(force[1], -std::copysign(std::min(std::abs(stick), limit), aside), 1e-12 * limit);
  }
}

/// A commit keeps the forces, remembers the elastic slip, and dissipates the rest of the work.
TEST_P(Friction, CommitKeepsForcesAndDissipatesWhatSlides) {
  OnPlane on(GetParam());
  const std::vector<double> rest(on.points.reference.size());
  History history;
  const std::vector<double> down = on.moved(0.05, 0.0);
  history = on.lagged(rest, down, history);
  static_cast<void>(on.assembler.commit(down, history));
  const double pressing = on.force(down, history)[0];
  const double rows = GetParam() == 3 ? 6.0 : 3.0, cell = GetParam() == 3 ? 0.01 : 0.05;
  const double stiffness = rows * 0.5 * modulus * cell / (0.5 * spacing);
  const double bearable = coefficient * pressing / stiffness;
  double elastic = 0.0, slid = 0.0, aside_before = 0.0;  // of the same spring and slider
  double dissipated = 0.0, work = 0.0, before = on.assembler.energy({down, history}).energy;
  const double start = before;
  std::vector<double> last = down;
  for (const double aside : {0.002, 0.05, 0.1, 0.04, -0.1}) {
    const std::vector<double> at = on.moved(0.05, aside);
    history = on.lagged(last, at, history);
    const double taken_up = on.assembler.energy({at, history}).energy - before;
    const Coordinates found = on.force(at, history);
    const Evaluation committed = on.assembler.commit(at, history);
    const Coordinates after = on.force(at, history);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(after[c], found[c], 1e-13 * pressing);
    EXPECT_GE(committed.released, 0.0);
    EXPECT_NEAR(committed.energy - before + committed.released, taken_up, 1e-13 * pressing);
    EXPECT_NEAR(on.assembler.energy({at, history}).energy, committed.energy, 1e-15);
    // The same state again moves nothing.
    History again = history;
    EXPECT_NEAR(on.assembler.commit(at, again).released, 0.0, 1e-15);
    before = committed.energy;
    dissipated += committed.released;
    work += taken_up;
    elastic += (aside - aside_before) * spacing;
    slid += std::max(0.0, std::abs(elastic) - bearable);
    elastic = std::clamp(elastic, -bearable, bearable);
    aside_before = aside;
    last = at;
  }
  EXPECT_NEAR(before - start + dissipated, work, 1e-12 * pressing);
  EXPECT_NEAR(dissipated, coefficient * pressing * slid, 1e-12 * pressing);
}

/// A contact that opens forgets its slip.
TEST_P(Friction, ContactsThatOpenAreForgotten) {
  OnPlane on(GetParam());
  const std::vector<double> rest(on.points.reference.size());
  const std::vector<double> pressed = on.moved(0.05, 0.01), open = on.moved(-1.0, 0.01);
  History history = on.lagged(rest, pressed, {});
  static_cast<void>(on.assembler.commit(pressed, history));
  EXPECT_FALSE(history.slips().empty());
  const double stored = on.assembler.energy({open, on.lagged(pressed, pressed, history)}).energy;
  EXPECT_GT(stored, 0.0);
  history = on.lagged(pressed, open, history);
  for (const double component : on.force(open, history)) EXPECT_EQ(component, 0.0);
  const Evaluation committed = on.assembler.commit(open, history);
  EXPECT_EQ(committed.energy, 0.0);
  EXPECT_GT(committed.released, 0.0);
  EXPECT_TRUE(history.slips().empty());
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Friction, ::testing::Values(2, 3),
                         [](const auto& param) { return std::to_string(param.param) + "D"; });

}  // namespace
}  // namespace peristat
