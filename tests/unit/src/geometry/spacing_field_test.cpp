#include "src/geometry/spacing_field.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "src/geometry/lattice.hpp"

namespace peristat {
namespace {

using Action = ShapeStep::Action;

TEST(SpacingField, GrowsWithTheDistanceFromTheFinestRegion) {
  const std::vector<Refinement> regions{{Disk{{0, 0, 0}, 1.0}, 0.1, 0.2},
                                        {Disk{{3, 0, 0}, 0.5}, 0.2, 0.1}};
  const SpacingField field(2, 0.5, regions);
  EXPECT_EQ(field.at({0.5, 0, 0}), 0.1);
  EXPECT_NEAR(field.at({0, 2, 0}), 0.1 + 0.2 * 1.0, 1e-15);
  EXPECT_EQ(field.at({3.1, 0, 0}), 0.2);
  EXPECT_NEAR(field.at({3, 1, 0}), 0.25, 1e-15);
  EXPECT_EQ(field.at({0, 10, 0}), 0.5);
  EXPECT_EQ(field.finest(), 0.1);
  EXPECT_EQ(field.region_at({0, 2, 0}), 0u);
  EXPECT_EQ(field.region_at({3, 1, 0}), 1u);
  EXPECT_FALSE(field.region_at({0, 10, 0}));
  EXPECT_NEAR(field.gradient({0, 2, 0})[1], 0.2, 1e-3);
  EXPECT_NEAR(field.gradient({0, 2, 0})[0], 0.0, 1e-12);
  EXPECT_EQ(field.gradient({0, 10, 0})[1], 0.0);
}

TEST(SpacingField, IsEvenWithoutRegions) {
  const std::vector<Refinement> none;
  const SpacingField field(3, 0.5, none);
  EXPECT_TRUE(field.is_even());
  EXPECT_EQ(field.at({1, 2, 3}), 0.5);
  EXPECT_EQ(field.most_points({{0, 0, 0}, {1, 1, 1}}), 0.0);
}

Lattice refined(int dimension, double spacing, std::vector<Refinement> regions) {
  Lattice lattice;
  lattice.dimension = dimension;
  lattice.arrangement = Arrangement::blue_noise;
  lattice.spacing = spacing;
  lattice.shapes = {{Action::add, Box{{-1, -1, -1}, {1, 1, 1}}},
                    {Action::subtract, Box{{0.7, 0.7, -2}, {2, 2, 2}}}};
  lattice.refinements = std::move(regions);
  return lattice;
}

// The number of points is the integral of h^-d over the body, and the bound holds.
TEST(SpacingField, RefinedPointsAreAsManyAsTheFieldAsksFor) {
  for (const int dimension : {2, 3}) {
    const double coarse = dimension == 2 ? 0.1 : 0.25;
    const Lattice lattice =
        refined(dimension, coarse, {{Box{{-0.3, -0.2, -0.2}, {0.3, 0.1, 0.2}}, 0.4 * coarse, 0.2}});
    const SpacingField field(dimension, coarse, lattice.refinements);
    const Points points = make_points(lattice);
    const Solid body(dimension, lattice.shapes);
    double due = 0.0;
    const int grid = dimension == 2 ? 400 : 80;
    const double edge = 2.0 / grid;
    for (int k = 0; k < std::pow(grid, dimension); ++k) {
      Coordinates at{-1 + edge * (0.5 + k % grid), -1 + edge * (0.5 + k / grid % grid), 0};
      if (dimension == 3) at[2] = -1 + edge * (0.5 + k / grid / grid);
      if (body.contains(at)) due += std::pow(edge / field.at(at), dimension);
    }
    EXPECT_NEAR(points.count() / due, 1.0, 0.015);
    EXPECT_GE(estimate_points(lattice), points.count());
    EXPECT_LT(estimate_points(lattice), 3.0 * points.count());
    double volume = 0.0;
    for (const double of_point : points.volume) volume += of_point;
    EXPECT_NEAR(volume, std::pow(2.0, dimension - 2) * (4.0 - 0.09), 1e-4);
    EXPECT_NEAR(points.cross_section(), 1.0, 1e-3);
    EXPECT_EQ(make_points(lattice).reference, points.reference);
  }
}

TEST(SpacingField, WrongRegionsAreRefused) {
  const auto refusal = [](Refinement region, Arrangement arrangement = Arrangement::blue_noise) {
    Lattice lattice = refined(2, 0.1, {std::move(region)});
    lattice.arrangement = arrangement;
    try {
      static_cast<void>(make_points(lattice));
    } catch (const InputError& error) {
      return error.key();
    }
    return std::string();
  };
  const Disk disk{{0, 0, 0}, 0.2};
  EXPECT_EQ(refusal({disk, 0.05, 0.1}), "");
  EXPECT_EQ(refusal({disk, 0.1, 0.1}), "refinements[0].spacing");
  EXPECT_EQ(refusal({disk, 0.001, 0.1}), "refinements[0].spacing");
  EXPECT_EQ(refusal({disk, NAN, 0.1}), "refinements[0].spacing");
  EXPECT_EQ(refusal({disk, 0.05, 0.0}), "refinements[0].growth");
  EXPECT_EQ(refusal({disk, 0.05, NAN}), "refinements[0].growth");
  EXPECT_EQ(refusal({Disk{{0, 0, 0}, -1.0}, 0.05, 0.1}), "refinements[0].radius");
  EXPECT_EQ(refusal({Disk{{9, 0, 0}, 0.2}, 0.05, 0.1}), "refinements[0].shape");
  EXPECT_EQ(refusal({disk, 0.05, 0.1}, Arrangement::lattice), "refinements");
}

}  // namespace
}  // namespace peristat
