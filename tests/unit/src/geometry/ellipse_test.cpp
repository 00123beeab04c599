#include "src/geometry/ellipse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/connectivity/crack.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/body_boundary.hpp"
#include "src/geometry/lattice.hpp"

namespace peristat {
namespace {

constexpr auto add = ShapeStep::Action::add, subtract = ShapeStep::Action::subtract;
constexpr double pi = std::numbers::pi;

const Ellipse turned{{0.3, -0.2, 0}, {0.9, 0.25, 0}, 37.0};
const Ellipse thin{{0, 0, 0}, {1e-3, 1.0, 0}, -20.0};

Coordinates place_of(const Ellipse& of, double t) {
  const Coordinates u = first_axis(of);
  const double x = of.radii[0] * std::cos(t), y = of.radii[1] * std::sin(t);
  return {of.centre[0] + x * u[0] - y * u[1], of.centre[1] + x * u[1] + y * u[0], 0.0};
}

TEST(Ellipse, HasItsBoundaryByDefinition) {
  for (const Ellipse& of : {turned, thin}) {
    for (int k = 0; k < 50; ++k) {
      const Coordinates at = place_of(of, 0.13 * k);
      const Coordinates arm = minus(at, of.centre);
      EXPECT_TRUE(contains(of, at));
      EXPECT_TRUE(contains(of, plus(of.centre, scaled(1 - 1e-6, arm))));
      EXPECT_FALSE(contains(of, plus(of.centre, scaled(1 + 1e-4, arm))));
      const Box box = bounds(of);
      for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_GE(at[c], box.min[c] - 1e-12);
        EXPECT_LE(at[c], box.max[c] + 1e-12);
      }
    }
  }
  // The angle goes from x towards y; at 90 degrees the radii change places.
  EXPECT_TRUE(contains(Ellipse{{0, 0, 0}, {1, 0.1, 0}, 45}, {0.7, 0.7, 0}));
  EXPECT_FALSE(contains(Ellipse{{0, 0, 0}, {1, 0.1, 0}, 45}, {0.7, -0.7, 0}));
  EXPECT_NEAR(bounds(Ellipse{{1, 2, 0}, {3, 0.5, 0}, 90}).max[0], 1.5, 1e-14);
  EXPECT_NEAR(bounds(Ellipse{{1, 2, 0}, {3, 0.5, 0}, 90}).max[1], 5.0, 1e-14);
}

// A boundary's slack is a distance, along the tip of a thin ellipse as along its flank.
TEST(Ellipse, TakesRoundOffForItsBoundaryButNotMore) {
  const Ellipse flat{{0, 0, 0}, {1, 1e-3, 0}, 0};
  for (const Coordinates& out : {Coordinates{1, 0, 0}, Coordinates{0, 1, 0}}) {
    const Coordinates end{flat.radii[0] * out[0], flat.radii[1] * out[1], 0};
    EXPECT_TRUE(contains(flat, plus(end, scaled(0.5 * boundary_tolerance, out))));
    EXPECT_FALSE(contains(flat, plus(end, scaled(10 * boundary_tolerance, out))));
  }
}

TEST(Ellipse, NearestPlaceIsThatOfDenseSamples) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (const Ellipse& of : {turned, thin, Ellipse{{0, 0, 0}, {2, 2, 0}, 10}}) {
    for (int sample = 0; sample < 100; ++sample) {
      Coordinates at{uniform(generator), uniform(generator), 0};
      if (sample == 0) at = of.centre;
      if (sample == 1) at = plus(of.centre, scaled(0.3 * of.radii[0], first_axis(of)));
      double least = 1e9;
      constexpr int places = 5000;
      for (int k = 0; k < places; ++k)
        least = std::min(least, length(minus(at, place_of(of, 2 * pi * k / places))));
      // Samples are at most 2 pi / places apart, and beside the nearest the distance grows
      // quadratically, on the boundary itself linearly.
      EXPECT_NEAR(distance_to(of, at), least, 1.5e-3);
      EXPECT_LE(distance_to(of, at), least + 1e-12);
    }
  }
}

double area_of(const Ellipse& of, double spacing, CellVolumes volumes, double angle = 0.0) {
  Lattice lattice;
  lattice.dimension = 2;
  lattice.spacing = spacing;
  lattice.angle = angle;
  lattice.volumes = volumes;
  lattice.shapes = {{add, of}};
  const Points points = make_points(lattice);
  return std::accumulate(points.volume.begin(), points.volume.end(), 0.0);
}

TEST(Ellipse, HasTheAreaPiABInCells) {
  const double exact = pi * turned.radii[0] * turned.radii[1];
  // Stairs: the sum's error falls about as spacing^(3/2).
  EXPECT_NEAR(area_of(turned, 0.01, CellVolumes::whole) / exact, 1.0, 5e-3);
  EXPECT_NEAR(area_of(turned, 0.001, CellVolumes::whole) / exact, 1.0, 2e-4);
  for (const double angle : {0.0, 17.0})
    EXPECT_NEAR(area_of(turned, 0.07, CellVolumes::fractional, angle) / exact, 1.0, 1e-9);
}

TEST(Ellipse, CutsTheBondsThatCrossIt) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int cut = 0, kept = 0;
  for (const Ellipse& of : {turned, Ellipse{{0, 0, 0}, {0.5, 0.05, 0}, 80}}) {
    for (int sample = 0; sample < 200; ++sample) {
      const Coordinates a{uniform(generator), uniform(generator), 0};
      const Coordinates b{a[0] + 0.3 * uniform(generator), a[1] + 0.3 * uniform(generator), 0};
      double deepest = -1e9;  // of dense samples of the bond, below the boundary
      for (int k = 0; k <= 300; ++k) {
        const Coordinates at = plus(a, scaled(k / 300.0, minus(b, a)));
        const double distance = distance_to(of, at);
        deepest = std::max(deepest, contains(of, at) ? distance : -distance);
      }
      if (std::abs(deepest) < 1e-3) continue;  // samples are up to 1.4e-3 apart
      EXPECT_EQ(cuts(CrackShape{of, 2}, a, b), deepest > 0);
      ++(deepest > 0 ? cut : kept);
    }
  }
  EXPECT_GT(cut, 20);
  EXPECT_GT(kept, 100);
}

/// Dense samples of the part of an ellipse on which the body ends.
std::vector<Coordinates> exposed_samples(const Ellipse& of, const Solid& body, double side) {
  constexpr int places = 5000;
  std::vector<Coordinates> samples;
  for (int k = 0; k < places; ++k) {
    const double t = 2 * pi * k / places;
    const Coordinates at = place_of(of, t);
    const Coordinates ahead = minus(place_of(of, t + 1e-6), at);
    const Coordinates out = scaled(side * 1e-6 / length(ahead), {ahead[1], -ahead[0], 0});
    if (body.contains(minus(at, out)) && !body.contains(plus(at, out))) samples.push_back(at);
  }
  return samples;
}

void expect_feet_of_samples(const std::vector<ShapeStep>& shapes, std::size_t number) {
  const Solid solid(2, shapes);
  const BodyBoundary boundary(2, shapes, {}, 0.05);
  const auto& of = std::get<Ellipse>(shapes[number].shape);
  const double side = shapes[number].action == add ? 1.0 : -1.0;
  const std::vector<Coordinates> samples = exposed_samples(of, solid, side);
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> uniform(-1.2, 1.2);
  int found = 0;
  for (int sample = 0; sample < 100; ++sample) {
    const Coordinates place{uniform(generator), uniform(generator), 0};
    for (const Foot& foot : boundary.near(place, 0.3)) {
      if (foot.part.shape != number) continue;
      double least = 1e9;
      for (const Coordinates& at : samples) least = std::min(least, length(minus(at, place)));
      // Samples are 2 pi 0.9 / 5000 apart, which counts in full at the end of a piece.
      EXPECT_NEAR(least, foot.distance, 1.2e-3);
      EXPECT_NEAR(distance_to(of, foot.at), 0.0, 1e-7);
      const bool is_end = length(cross(minus(place, foot.at), foot.normal)) > 1e-6;
      EXPECT_TRUE(is_end || (solid.contains(minus(foot.at, scaled(1e-5, foot.normal))) &&
                             !solid.contains(plus(foot.at, scaled(1e-5, foot.normal)))));
      EXPECT_NEAR(length(foot.normal), 1.0, 1e-12);
      ++found;
    }
  }
  EXPECT_GT(found, 10);
}

TEST(Ellipse, HasFeetOnItsBoundary) {
  expect_feet_of_samples({{add, turned}}, 0);
  expect_feet_of_samples({{add, Box{{-2, -2, 0}, {2, 2, 0}}}, {subtract, turned}}, 1);
  // Cut off by a side, by a disk and by another ellipse.
  expect_feet_of_samples({{add, Box{{-1, -1, 0}, {0.4, 1, 0}}}, {subtract, turned}}, 1);
  expect_feet_of_samples({{add, turned}, {subtract, Disk{{0.8, 0.2, 0}, 0.4}}}, 0);
  expect_feet_of_samples({{add, turned}, {subtract, Ellipse{{0.4, 0, 0}, {0.05, 0.8, 0}, 10}}}, 0);
}

TEST(Ellipse, OfEqualRadiiIsADisk) {
  const std::vector<ShapeStep> disk{{add, Box{{-1, 0, 0}, {1, 1, 0}}},
                                    {subtract, Disk{{0, 1, 0}, 0.5}}};
  const std::vector<ShapeStep> ellipse{disk[0], {subtract, Ellipse{{0, 1, 0}, {0.5, 0.5, 0}, 30}}};
  const BodyBoundary one(2, disk, {}, 0.05), other(2, ellipse, {}, 0.05);
  for (const Coordinates& at : {Coordinates{0.6, 0.95, 0}, Coordinates{0.45, 0.75, 0},
                                Coordinates{0.0, 0.45, 0}, Coordinates{-0.51, 0.99, 0}}) {
    const auto of_one = one.near(at, 0.3), of_other = other.near(at, 0.3);
    ASSERT_EQ(of_one.size(), of_other.size());
    for (std::size_t k = 0; k < of_one.size(); ++k) {
      EXPECT_LT(length(minus(of_one[k].at, of_other[k].at)), 1e-10);
      EXPECT_LT(length(minus(of_one[k].normal, of_other[k].normal)), 1e-10);
    }
  }
  EXPECT_EQ(one.outermost({1, 1}), other.outermost({1, 1}));
}

TEST(Ellipse, IsNoFlatSide) {
  const std::vector<ShapeStep> shapes{{add, Box{{-1, 0, 0}, {1, 1, 0}}},
                                      {add, Ellipse{{0, 0.9, 0}, {0.5, 0.2, 0}, 5}}};
  const BodyBoundary boundary(2, shapes, {}, 0.05);
  EXPECT_EQ(boundary.outermost({1, 1}), std::nullopt);
  EXPECT_EQ(boundary.outermost({1, -1}), 0.0);
}

std::string refused_key(const Ellipse& of, int dimension = 2) {
  try {
    check_shape(of, dimension, "table", "table.add");
  } catch (const InputError& error) {
    return error.key();
  }
  return "nothing";
}

TEST(Ellipse, IsRefusedIfItIsNone) {
  EXPECT_EQ(refused_key(turned), "nothing");
  EXPECT_EQ(refused_key(turned, 3), "table.add");
  EXPECT_EQ(refused_key({{0, 0, 0}, {1, 0, 0}, 0}), "table.radii");
  EXPECT_EQ(refused_key({{0, 0, 0}, {-1, 1, 0}, 0}), "table.radii");
  EXPECT_EQ(refused_key({{0, 0, 0}, {1, 1e-7, 0}, 0}), "table.radii");
  EXPECT_EQ(refused_key({{0, NAN, 0}, {1, 1, 0}, 0}), "table.centre");
  EXPECT_EQ(refused_key({{0, 0, 0}, {1, 1, 0}, INFINITY}), "table.angle");
}

}  // namespace
}  // namespace peristat
