#include "solvers/drivers/arc_length_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/study/study.hpp"

namespace peristat {
namespace {

constexpr double full_load = 3000.0;  // [N], at load factor 1
constexpr double micromodulus = 1e6;

/// Two bars that lean against each other, of points with volume 1: von Mises' truss. Each has the
/// force c s, s = l/L - 1.
struct Truss {
  double height;
  std::unique_ptr<const Body> body;

  explicit Truss(double of_height, const std::string& support_motion = "0",
                 const std::string& load = "-3000*load", const DamageSpecification& damage = {},
                 const std::vector<ObstacleSpecification>& obstacles = {})
      : height(of_height) {
    Points points;
    points.dimension = 2;
    points.spacing = 1.0;
    points.reference = {-1.0, 0.0, 0.0, height, 1.0, 0.0};
    points.volume = {1.0, 1.0, 1.0};
    points.sets = {{"feet", {0, 2}}, {"top", {1}}};
    BodySpecification of;
    of.horizon = std::hypot(1.0, height) * 1.01;
    of.material.micromodulus = micromodulus;
    of.material.damage = damage;
    of.supports = {{"feet", {"0", support_motion}}};
    of.loads = {{LoadSpecification::Kind::total_force, "top", {"0", load, "0"}}};
    of.obstacles = obstacles;
    body = make_body(std::move(points), of, 1);
  }

  [[nodiscard]] double stretch(double x, double y) const {
    return std::hypot(1.0 + x, y) / std::hypot(1.0, height) - 1.0;
  }
  /// Load factor in equilibrium with the top at height y between its feet.
  [[nodiscard]] double load_factor(double y) const {
    return -2.0 * micromodulus * stretch(0.0, y) * y / std::hypot(1.0, y) / full_load;
  }
};

StudyOptions arc_length(int steps) {
  StudyOptions options;
  options.loading.mode = Mode::arc_length;
  options.loading.steps = steps;
  options.threads = 1;
  return options;
}

struct Passed {
  double x, y, load_factor;
  std::int64_t negative_pivots;
};

struct Path {
  StudyResult result;
  std::vector<Passed> passed;
};

Path follow(const Truss& truss, const StudyOptions& options) {
  Path path;
  LoadSteppingObserver observer;
  observer.accepted = [&](const StepRecord& record, const AcceptedState& state) {
    if (record.step == 0) return;
    const std::vector<double>& u = state.trial.displacement;
    path.passed.push_back({u[2], truss.height + u[3], record.load_factor, record.negative_pivots});
  };
  path.result = solve(*truss.body, options, observer);
  return path;
}

std::vector<std::string> located(const StudyResult& result) {
  std::vector<std::string> reasons;
  for (const DecisionRecord& decision : result.decisions) {
    if (decision.action == Decision::locate) reasons.push_back(decision.reason);
  }
  return reasons;
}

/// Of a function that is negative at `low` and positive at `high`.
double root(double low, double high, const std::function<double(double)>& of) {
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (of(middle) < 0.0 ? low : high) = middle;
  }
  return low;
}

TEST(ArcLength, SnapsThroughAlongTheClosedForm) {
  const Truss truss(0.2);
  double highest = 0.0, height_of_limit = 0.0;
  for (double y = 0.0; y < truss.height; y += 1e-6) {
    if (truss.load_factor(y) <= highest) continue;
    highest = truss.load_factor(y);
    height_of_limit = y;
  }
  ASSERT_LT(highest, 1.0);
  for (const int steps : {3, 20}) {
    SCOPED_TRACE(steps);
    const Path path = follow(truss, arc_length(steps));
    ASSERT_EQ(path.result.outcome, Outcome::converged);
    EXPECT_EQ(path.result.state.stage, 1.0);
    double largest = 0.0, before = truss.height;
    for (const Passed& at : path.passed) {
      EXPECT_NEAR(at.load_factor, truss.load_factor(at.y), 1e-9);
      EXPECT_NEAR(at.x, 0.0, 1e-12);
      EXPECT_LT(at.y, before);  // never back
      if (std::abs(std::abs(at.y) - height_of_limit) > 1e-4) {
        EXPECT_EQ(at.negative_pivots, std::abs(at.y) < height_of_limit ? 1 : 0) << at.y;
      }
      before = at.y;
      if (at.y > 0.0) largest = std::max(largest, at.load_factor);
    }
    EXPECT_LT(path.passed.back().y, -truss.height);
    // The limit point is located to a thousandth of a step, so that its load is known far better.
    EXPECT_NEAR(largest, highest, 1e-5 * highest);
    const std::vector<std::string> points = located(path.result);
    ASSERT_EQ(points.size(), 2u);
    for (const std::string& reason : points) EXPECT_EQ(reason.find("a limit point"), 0u) << reason;
  }
}

TEST(ArcLength, SnapsThroughOntoAnObstacle) {
  // The top meets the plane where it is unstable: the load falls before and rises behind, while the
  // top stays.
  constexpr double meets = 0.05, half_a_cell = 0.5;
  ObstacleSpecification plane;
  plane.name = "plane";
  plane.set = "top";
  plane.surface = {.kind = RigidSurface::Kind::plane,
                   .point = {0.0, meets - half_a_cell, 0.0},
                   .direction = {0.0, 1.0, 0.0}};
  const Truss truss(0.2, "0", "-3000*load", {}, {plane});
  const Obstacles& obstacles = truss.body->conditions->obstacles();
  const double most = obstacles.all()[0].depth * half_a_cell;
  const auto pressed = [&](double y) {
    const double k = obstacles.contacts()[0].stiffness;
    return k * most * obstacles.all()[0].law((meets - y) / most).first / full_load;
  };
  for (const int steps : {3, 20}) {
    SCOPED_TRACE(steps);
    const Path path = follow(truss, arc_length(steps));
    ASSERT_EQ(path.result.outcome, Outcome::converged);
    EXPECT_EQ(path.result.state.stage, 1.0);
    double before = truss.height, least = 1.0;
    for (const Passed& at : path.passed) {
      EXPECT_NEAR(at.load_factor, truss.load_factor(at.y) + pressed(at.y), 1e-8);
      EXPECT_LT(at.y, before);
      before = at.y;
      if (at.y < 0.1) least = std::min(least, at.load_factor);
    }
    EXPECT_LT(before, meets);
    EXPECT_GT(before, meets - 0.1 * most);
    EXPECT_NEAR(least, truss.load_factor(meets), 1e-3);
    EXPECT_EQ(located(path.result).size(), 2u);
    EXPECT_LT(path.passed.size(), 100u);
  }
}

TEST(ArcLength, FollowsSupportsAsLoads) {
  // Feet that rise carry the top with them.
  const Truss truss(0.2, "load*0.45", "0");
  const Path path = follow(truss, arc_length(10));
  ASSERT_EQ(path.result.outcome, Outcome::converged);
  for (const Passed& at : path.passed) EXPECT_NEAR(at.y - 0.45 * at.load_factor, 0.2, 1e-12);
}

TEST(ArcLength, BranchesOffWhereATallTrussSways) {
  const Truss truss(4.0, "0", "-400000*load");
  // K_xx = 2 c (cos^2 / L + s sin^2 / l) vanishes.
  const double tall = std::hypot(1.0, truss.height);
  const double y = root(3.0, 4.0, [&](double at) {
    const double l = std::hypot(1.0, at), s = truss.stretch(0.0, at);
    return 1.0 / (l * l) / tall + s * at * at / (l * l) / l;
  });
  const double critical = truss.load_factor(y) * full_load / 4e5;
  ASSERT_GT(critical, 0.0);
  ASSERT_LT(critical, 1.0);
  for (const bool branches : {true, false}) {
    SCOPED_TRACE(branches);
    StudyOptions options = arc_length(20);
    options.loading.arc_length.branches_off = branches;
    options.loading.arc_length.steps = 60;
    const Path path = follow(truss, options);
    ASSERT_EQ(path.result.outcome, Outcome::converged);
    const std::vector<std::string> points = located(path.result);
    ASSERT_FALSE(points.empty());
    EXPECT_EQ(points.front().find("a bifurcation"), 0u) << points.front();
    const auto unstable = std::find_if(
        path.passed.begin(), path.passed.end(),
        [](const Passed& at) { return at.negative_pivots > 0 || std::abs(at.x) > 1e-6; });
    ASSERT_NE(unstable, path.passed.end());
    EXPECT_NEAR((unstable - 1)->load_factor, critical, 2e-4 * critical);
    const Passed& last = path.passed.back();
    EXPECT_EQ(std::abs(last.x) > 0.1, branches);
    // Equilibrium of the top, wherever it is.
    const double left = micromodulus * truss.stretch(last.x, last.y),
                 right = micromodulus * truss.stretch(-last.x, last.y);
    const double l = std::hypot(1.0 + last.x, last.y), r = std::hypot(1.0 - last.x, last.y);
    EXPECT_NEAR(left * (1.0 + last.x) / l, right * (1.0 - last.x) / r, 1e-9 * micromodulus);
    EXPECT_NEAR((left * last.y / l + right * last.y / r) / 4e5, -last.load_factor, 1e-9);
  }
}

TEST(ArcLength, EndsAfterItsSteps) {
  StudyOptions options = arc_length(20);
  options.loading.arc_length.steps = 4;
  const Path path = follow(Truss(0.2), options);
  EXPECT_EQ(path.result.outcome, Outcome::converged);
  EXPECT_EQ(path.passed.size(), 4u);
  EXPECT_LT(path.passed.back().load_factor, 1.0);
}

TEST(ArcLength, StopsBeforeDamage) {
  DamageSpecification damage;
  damage.law = DamageLaw::critical_stretch;
  damage.critical = 0.005;  // only drawn bars break: beyond the snap
  const Truss truss(0.2, "0", "-3000*load", damage);
  const Path path = follow(truss, arc_length(20));
  EXPECT_EQ(path.result.outcome, Outcome::damage_begins);
  const Passed& last = path.passed.back();
  EXPECT_LT(truss.stretch(0.0, last.y), damage.critical);
  EXPECT_NEAR(truss.stretch(0.0, last.y), damage.critical, 2e-5);
}

TEST(ArcLength, RefusesWhatNothingMoves) {
  StudyOptions options = arc_length(20);
  const Truss still(0.2, "0", "0");
  EXPECT_THROW((void)follow(still, options), InputError);
  options.linear.method = LinearMethod::cholesky;
  EXPECT_THROW((void)follow(Truss(0.2), options), InputError);
}

}  // namespace
}  // namespace peristat
