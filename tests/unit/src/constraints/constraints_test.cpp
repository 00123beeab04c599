#include "src/constraints/constraints.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace peristat {
namespace {

/// Points of a cube of 3 x 3 x 3 and what may follow there: images beyond a plane and a period, a
/// rigid set that the plane cuts, a point on a slope.
struct Tied {
  explicit Tied(int dimension) {
    points.dimension = dimension;
    points.spacing = 1.0;
    for (int k = 0; k < (dimension == 3 ? 27 : 9); ++k) {
      points.reference.push_back(0.5 + k % 3);
      points.reference.push_back(0.5 + k / 3 % 3);
      if (dimension == 3) points.reference.push_back(0.5 + k / 9);
      points.volume.push_back(1.0);
    }
    add_images(points, {{0, 0.0}}, {{1, 0.0, 3.0}}, 1.1);
  }

  [[nodiscard]] Constraints constraints() const {
    Constraints made(points);
    Constraints::RigidSet set;
    set.members = {0, 1, 3, 4};
    if (points.dimension == 3) set.members.push_back(9);
    set.centre = {0.7, 0.9, points.dimension == 3 ? 0.6 : 0.0};
    set.size = 1.7;
    set.translation = made.add_handle(set.centre);
    set.rotation = made.add_handle(set.centre);
    made.follow(set);
    const Index slope = made.add_handle({});
    Dependence on{slope, {}};
    on.block[0] = {0.6, -0.8, 0.0};
    on.block[1] = {0.8, 0.6, 0.0};
    on.block[2] = {0.0, 0.0, 1.0};
    made.follow(8, {true, true, true}, {on});
    // One component that follows others of itself and of another point.
    Dependence own{7, {}}, other{2, {}};
    own.block[0][1] = 0.3;
    other.block[0] = {-0.7, 0.2, 0.0};
    made.follow(7, {true, false, false}, {own, other});
    return made;
  }

  Points points;
};

std::vector<double> random_vector(std::size_t size, unsigned seed, double scale) {
  std::mt19937 engine(seed);
  std::vector<double> values(size);
  for (double& value : values) value = scale * (double(engine()) / 2147483648.0 - 1.0);
  return values;
}

class ConstraintsIn : public testing::TestWithParam<int> {};

TEST_P(ConstraintsIn, FoldForcesByTheRatesOfMotions) {
  const Tied tied(GetParam());
  const Constraints constraints = tied.constraints();
  std::vector<double> at = random_vector(constraints.dofs(), 1, 0.4);
  constraints.move(at);
  const std::vector<double> load = random_vector(constraints.dofs(), 2, 1.0);
  std::vector<double> gradient = random_vector(constraints.dofs(), 3, 1.0);
  const std::size_t of_points = tied.points.reference.size();
  const std::size_t own = std::size_t(tied.points.own()) * std::size_t(GetParam());
  std::vector<double> external = load;
  std::fill(external.begin() + std::ptrdiff_t(own), external.end(), 0.0);  // none on images
  const auto work = [&](std::vector<double> displacement) {
    constraints.move(displacement);
    double sum = 0.0;
    for (std::size_t dof = 0; dof < of_points; ++dof) {
      sum += (gradient[dof] - external[dof]) * displacement[dof];
    }
    return sum;
  };
  std::vector<double> folded = gradient;
  constraints.fold(at, external, folded);
  const double h = 1e-5;
  for (std::size_t dof = 0; dof < constraints.dofs(); ++dof) {
    if (constraints.dependent()[dof]) continue;
    std::vector<double> forward = at, backward = at;
    forward[dof] += h;
    backward[dof] -= h;
    EXPECT_NEAR(folded[dof] - external[dof], (work(forward) - work(backward)) / (2.0 * h), 1e-8)
        << dof;
  }
}

TEST_P(ConstraintsIn, ExtendRatesAsPointsMove) {
  const Tied tied(GetParam());
  const Constraints constraints = tied.constraints();
  std::vector<double> at = random_vector(constraints.dofs(), 4, 0.4);
  constraints.move(at);
  std::vector<double> rate = random_vector(constraints.dofs(), 5, 1.0);
  const double h = 1e-5;
  std::vector<double> forward = at, backward = at;
  for (std::size_t dof = 0; dof < at.size(); ++dof) {
    forward[dof] += h * rate[dof];
    backward[dof] -= h * rate[dof];
  }
  constraints.move(forward);
  constraints.move(backward);
  constraints.extend(at, rate);
  for (std::size_t dof = 0; dof < at.size(); ++dof) {
    EXPECT_NEAR(rate[dof], (forward[dof] - backward[dof]) / (2.0 * h), 1e-8);
  }
}

TEST_P(ConstraintsIn, HaveRowsThatGiveTheRates) {
  const Tied tied(GetParam());
  const Constraints constraints = tied.constraints();
  const std::size_t d = std::size_t(GetParam());
  std::vector<double> at = random_vector(constraints.dofs(), 6, 0.4);
  constraints.move(at);
  std::vector<double> rate = random_vector(constraints.dofs(), 7, 1.0);
  constraints.extend(at, rate);
  for (Index i = 0; i < tied.points.count(); ++i) {
    for (std::size_t r = 0; r < d; ++r) {
      double sum = 0.0;
      for (const Dependence& on : constraints.dependences(i, at)) {
        for (std::size_t c = 0; c < d; ++c) {
          const std::size_t dof = std::size_t(on.master) * d + c;
          EXPECT_TRUE(on.block[r][c] == 0.0 || !constraints.dependent()[dof]);
          sum += on.block[r][c] * rate[dof];
        }
      }
      EXPECT_NEAR(sum, rate[std::size_t(i) * d + r], 1e-13);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, ConstraintsIn, testing::Values(2, 3));

}  // namespace
}  // namespace peristat
