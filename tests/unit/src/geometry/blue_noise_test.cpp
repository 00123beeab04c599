#include "src/geometry/blue_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "src/core/counter_random.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/poisson_disk.hpp"

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi;
using Action = ShapeStep::Action;

Lattice blue_noise(int dimension, double spacing, std::vector<ShapeStep> shapes) {
  Lattice lattice;
  lattice.dimension = dimension;
  lattice.arrangement = Arrangement::blue_noise;
  lattice.spacing = spacing;
  lattice.shapes = std::move(shapes);
  return lattice;
}

const ShapeStep square{Action::add, Box{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}};

double sum_of(const Points& points) {
  double sum = 0.0;
  for (const double volume : points.volume) sum += volume;
  return sum;
}

/// Distance of every place from its nearest neighbour, the least of them.
double least_distance(const std::vector<Coordinates>& places) {
  double least = 1e9;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      double squared = 0.0;
      for (std::size_t c = 0; c < 3; ++c)
        squared += (places[i][c] - places[j][c]) * (places[i][c] - places[j][c]);
      least = std::min(least, squared);
    }
  }
  return std::sqrt(least);
}

std::vector<Coordinates> places_of(const Points& points) {
  std::vector<Coordinates> places;
  for (Index i = 0; i < points.count(); ++i) places.push_back(points.position(i));
  return places;
}

std::vector<Coordinates> disk_places(const Solid& body, std::size_t count, double spacing,
                                     std::uint64_t seed) {
  const std::vector<Refinement> none;
  return poisson_disk_places(body, count, SpacingField(body.dimension(), spacing, none),
                             {{body.bounds(), 1.0}}, seed);
}

// What every body has: one point per cell's volume, and the body's volume among them.
TEST(BlueNoise, VolumesAreTheBodys) {
  struct Body {
    Lattice lattice;
    double volume, tolerance;
  };
  const std::vector<std::array<double, 2>> dart{{-0.5, -0.5}, {0.5, -0.5}, {0.1, 0.0}, {0.5, 0.6}};
  double of_dart = 0.0;
  for (std::size_t k = 0; k < 4; ++k)
    of_dart += 0.5 * (dart[k][0] * dart[(k + 1) % 4][1] - dart[k][1] * dart[(k + 1) % 4][0]);
  const ShapeStep corner{Action::subtract, Box{{0, 0, -1}, {0.5, 0.5, 1}}};
  for (const auto& [lattice, volume, tolerance] :
       {Body{blue_noise(2, 0.03, {square}), 1.0, 1e-12},
        Body{blue_noise(3, 0.12, {square}), 1.0, 1e-12},
        Body{blue_noise(2, 0.03, {square, corner}), 0.75, 1e-12},
        Body{blue_noise(2, 0.03, {{Action::add, Polygon{dart}}}), of_dart, 1e-12},
        Body{blue_noise(2, 0.03, {square, {Action::subtract, Disk{{0.1, 0, 0}, 0.2}}}),
             1.0 - pi * 0.04, 1e-11},
        Body{blue_noise(2, 0.03, {{Action::add, Disk{{0, 0, 0}, 0.5}}}), pi * 0.25, 1e-11},
        Body{blue_noise(3, 0.25, {square, {Action::subtract, Sphere{{0, 0, 0}, 0.3}}}),
             1.0 - 4.0 / 3.0 * pi * 0.027, 1e-4}}) {
    const Points points = make_points(lattice);
    EXPECT_EQ(points.count(),
              Index(std::lround(volume / std::pow(lattice.spacing, lattice.dimension))));
    EXPECT_NEAR(sum_of(points) / volume, 1.0, tolerance);
    const Solid body(lattice.dimension, lattice.shapes);
    for (Index i = 0; i < points.count(); ++i) EXPECT_TRUE(body.contains(points.position(i)));
    EXPECT_FALSE(points.lattice.has_value());
    EXPECT_NEAR(points.cross_section(), 1.0, 1e-14);
  }
}

// Points stand at centroids: first moments are the body's, too.
TEST(BlueNoise, HasTheBodysCentroid) {
  const ShapeStep corner{Action::subtract, Box{{0, 0, 0}, {0.5, 0.5, 0}}};
  Lattice lattice = blue_noise(2, 0.04, {square, corner});
  lattice.cross_section = 0.01;
  for (const int steps : {0, 3}) {
    lattice.lloyd_steps = steps;
    const Points points = make_points(lattice);
    EXPECT_NEAR(sum_of(points), 0.0075, 1e-14);
    for (const std::size_t c : {0u, 1u}) {
      double moment = 0.0;
      for (Index i = 0; i < points.count(); ++i) moment += points.volume[i] * points.position(i)[c];
      EXPECT_NEAR(moment, 0.01 * -0.25 * 0.25, 1e-14);
    }
  }
}

// Poisson-disk places are apart, and leave no room for another one.
TEST(BlueNoise, PlacesKeepTheirDistanceAndFillTheBody) {
  for (const int dimension : {2, 3}) {
    const std::vector<ShapeStep> shapes{square};
    const Solid body(dimension, shapes);
    const std::size_t count = 1000;
    const double spacing = std::pow(1.0 / double(count), 1.0 / dimension);
    const std::vector<Coordinates> places = disk_places(body, count, spacing, 4);
    ASSERT_EQ(places.size(), count);
    const double least = least_distance(places);
    EXPECT_GT(least, (dimension == 2 ? 0.7 : 0.79) * spacing);
    double farthest = 0.0;
    for (std::uint64_t k = 0; k < 20000; ++k) {
      Coordinates at{};
      for (std::size_t c = 0; c < std::size_t(dimension); ++c)
        at[c] = open_unit(random_bits(random_bits(99, k), c)) - 0.5;
      double nearest = 1e9;
      for (const Coordinates& place : places) {
        double squared = 0.0;
        for (std::size_t c = 0; c < 3; ++c) squared += (place[c] - at[c]) * (place[c] - at[c]);
        nearest = std::min(nearest, squared);
      }
      farthest = std::max(farthest, std::sqrt(nearest));
    }
    EXPECT_LT(farthest, 1.35 * least);
  }
}

// Lloyd's steps even out distances and volumes.
TEST(BlueNoise, LloydStepsEvenOut) {
  Lattice lattice = blue_noise(2, 0.03, {square});
  double distance = 0.0, spread = 1e9;
  for (const int steps : {0, 5, 40}) {
    lattice.lloyd_steps = steps;
    const Points points = make_points(lattice);
    const auto [least, most] = std::minmax_element(points.volume.begin(), points.volume.end());
    const double apart = least_distance(places_of(points)) / lattice.spacing;
    EXPECT_GT(apart, distance);
    EXPECT_LT(*most / *least, spread);
    distance = apart;
    spread = *most / *least;
  }
  EXPECT_GT(distance, 0.72);
  EXPECT_LT(spread, 2.2);
}

TEST(BlueNoise, FollowsFromTheSeed) {
  Lattice lattice = blue_noise(2, 0.05, {square, {Action::subtract, Disk{{0, 0, 0}, 0.2}}});
  const Points one = make_points(lattice), again = make_points(lattice);
  EXPECT_EQ(one.reference, again.reference);
  EXPECT_EQ(one.volume, again.volume);
  lattice.seed = 2;
  EXPECT_NE(make_points(lattice).reference, one.reference);
}

// Integers and what IEEE 754 rounds: these are the places of seed 1 on every machine.
TEST(BlueNoise, PlacesAreTheSameEverywhere) {
  const std::vector<ShapeStep> shapes{square};
  const std::vector<Coordinates> places = disk_places(Solid(2, shapes), 100, 0.1, 1);
  EXPECT_EQ(places.front(), (Coordinates{0.44093178170424896, 0.29098681336104526, 0.0}));
  EXPECT_EQ(places.back(), (Coordinates{-0.35855522230840442, -0.044032872170911008, 0.0}));
}

TEST(BlueNoise, RefusesWhatNeedsALattice) {
  const auto refusal = [](auto change) {
    Lattice lattice = blue_noise(2, 0.1, {square});
    change(lattice);
    try {
      static_cast<void>(make_points(lattice));
    } catch (const InputError& error) {
      return error.key();
    }
    return std::string();
  };
  EXPECT_EQ(refusal([](Lattice&) {}), "");
  EXPECT_EQ(refusal([](Lattice& of) { of.dimension = 1; }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.spacing = Spacing({0.1, 0.2, 0}, 2); }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.angle = 10.0; }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.origin = LatticeOrigin::nodes; }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.volumes = CellVolumes::fractional; }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.perturbation = 0.1; }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.cell_perturbation = 0.1; }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.layers = {{"left", {0, -1}, 2, ""}}; }), "arrangement");
  EXPECT_EQ(refusal([](Lattice& of) { of.lloyd_steps = -1; }), "lloyd_steps");
  EXPECT_EQ(refusal([](Lattice& of) { of.spacing = 2.0; }), "shapes");
}

}  // namespace
}  // namespace peristat
