#include "src/geometry/shape.hpp"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

const Box box{{-1, -2, -3}, {1, 2, 3}};
const Disk disk{{1, 2, 0}, 0.5};
const Sphere sphere{{1, 2, 3}, 0.5};
const Cylinder upright{{1, 2, 3}, {0, 0, 2}, 0.5, 4.0};
const Cylinder oblique{{0, 0, 0}, {1, 1, 0}, 0.5, 2.0};
// An L: a concave corner at (1, 1).
const Polygon corner{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}};

struct Membership {
  const char* name;
  Shape shape;
  std::vector<Coordinates> inside, boundary, outside;
};

const double half_root = std::sqrt(0.5);
const std::vector<Membership> memberships{
    {"box", box, {{0, 0, 0}}, {{1, 2, 3}, {-1, 0, 0}}, {{1.01, 0, 0}, {0, 0, -3.01}}},
    {"disk", disk, {{1, 2, 0}}, {{1.3, 2.4, 0}, {0.5, 2, 0}}, {{1.31, 2.4, 0}}},
    {"sphere", sphere, {{1, 2, 3}}, {{1.3, 2, 2.6}}, {{1.3, 2.1, 2.6}}},
    {"cylinder", upright, {{1, 2, 4.9}}, {{1.3, 2.4, 5}}, {{1.3, 2.4, 5.01}, {1.31, 2.4, 3}}},
    // Its axis ends at (1, 1, 0) / sqrt(2) and its surface is met at (1, -1, 0) / sqrt(8).
    {"oblique cylinder",
     oblique,
     {{0.7, 0.7, 0.4}},
     {{half_root, half_root, 0.5}, {half_root / 2, -half_root / 2, 0}},
     {{0.72, 0.72, 0}, {0.36, -0.36, 0}}},
    {"polygon",
     corner,
     {{0.5, 0.5, 7}, {1.5, 0.5, 0}, {0.5, 1.5, 0}, {0.5, 1, 0}},
     {{1, 1, 0}, {0, 1, 0}, {1.5, 1, 0}, {0, 0, 0}, {2, 1, 0}},
     {{1.5, 1.5, 0}, {1.01, 1.01, 0}, {-0.1, 1, 0}, {2.1, 1, 0}, {3, 2, 0}}}};

TEST(Shape, ContainsItsInsideAndItsBoundaryOnly) {
  for (const Membership& m : memberships) {
    for (const auto& place : m.inside) EXPECT_TRUE(contains(m.shape, place)) << m.name;
    for (const auto& place : m.boundary) EXPECT_TRUE(contains(m.shape, place)) << m.name;
    for (const auto& place : m.outside) EXPECT_FALSE(contains(m.shape, place)) << m.name;
  }
}

TEST(Shape, TakesRoundOffForItsBoundaryButNotMore) {
  const double tenths = 3 * 0.1;  // 0.30000000000000004
  ASSERT_GT(tenths, 0.3);
  EXPECT_TRUE(contains(Box{{0, 0, 0}, {0.3, 1, 0}}, {tenths, 0, 0}));
  EXPECT_TRUE(contains(Box{{-infinity, 0, 0}, {0.3, 1, 0}}, {tenths, 0, 0}));
  EXPECT_TRUE(contains(Disk{{0, 0, 0}, 0.3}, {tenths, 0, 0}));
  EXPECT_TRUE(contains(Polygon{{{0, 0}, {0.3, 0}, {0.3, 1}}}, {tenths, 0.5, 0}));
  // A hundred times the tolerance is outside.
  const double beyond = 100 * boundary_tolerance;
  EXPECT_FALSE(contains(Box{{0, 0, 0}, {1, 1, 0}}, {1 + beyond, 0, 0}));
  EXPECT_FALSE(contains(Disk{{0, 0, 0}, 1}, {1 + beyond, 0, 0}));
  EXPECT_FALSE(contains(Polygon{{{0, 0}, {1, 0}, {1, 1}}}, {1 + beyond, 0.5, 0}));
}

TEST(Shape, KeepsItsToleranceSmallFarFromTheOrigin) {
  const Disk far{{1e6, 0, 0}, 1e-3};
  EXPECT_TRUE(contains(far, {1e6 + 1e-3, 0, 0}));  // off by up to 1e6 x 1e-16 = 1e-10
  EXPECT_FALSE(contains(far, {1e6 + 1.001e-3, 0, 0}));
}

TEST(Shape, LiesWithinItsBoundsAndReachesThem) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  const std::vector<Shape> shapes{box, sphere, upright, oblique,
                                  Cylinder{{1, 0, 2}, {1, 2, -0.5}, 0.3, 1.5}};
  for (const Shape& shape : shapes) {
    const Box around = bounds(shape);
    Coordinates low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    for (int sample = 0; sample < 200000; ++sample) {
      Coordinates place;
      for (int c = 0; c < 3; ++c) {
        const double edge = around.max[c] - around.min[c];
        place[c] = around.min[c] + (1.4 * uniform(generator) - 0.2) * edge;
      }
      if (!contains(shape, place)) continue;
      for (int c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], place[c]);
        high[c] = std::max(high[c], place[c]);
      }
    }
    for (int c = 0; c < 3; ++c) {
      // The samples are about 1.4 edges / 200000^(1/3) = 0.024 edges apart, and a smooth shape
      // touches its box in single points or lines; 0.1 edges catches a wrong half extent.
      const double edge = around.max[c] - around.min[c];
      EXPECT_GE(low[c], around.min[c] - 1e-8 * edge);
      EXPECT_LE(high[c], around.max[c] + 1e-8 * edge);
      EXPECT_LT(low[c], around.min[c] + 0.1 * edge);
      EXPECT_GT(high[c], around.max[c] - 0.1 * edge);
    }
  }
}

TEST(Shape, IsUnboundedWhereItHasNoEnd) {
  EXPECT_EQ(bounds(corner).max, (Coordinates{2, 2, infinity}));
  const Box column = bounds(Cylinder{{1, 2, 0}, {0, 0, 1}, 0.5});
  EXPECT_EQ(column.min, (Coordinates{0.5, 1.5, -infinity}));
  EXPECT_EQ(column.max, (Coordinates{1.5, 2.5, infinity}));
  EXPECT_TRUE(contains(Cylinder{{1, 2, 0}, {0, 0, 1}, 0.5}, {1, 2, 1e9}));
}

std::string refused_key(const Shape& shape, int dimension) {
  try {
    check_shape(shape, dimension, "table", "table.add");
  } catch (const InputError& error) {
    return error.key();
  }
  return "nothing";
}

TEST(CheckShape, AcceptsWhatFitsTheDimension) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    EXPECT_EQ(refused_key(box, dimension), "nothing");
    EXPECT_EQ(refused_key(disk, dimension), dimension == 2 ? "nothing" : "table.add");
    EXPECT_EQ(refused_key(sphere, dimension), dimension == 3 ? "nothing" : "table.add");
    EXPECT_EQ(refused_key(upright, dimension), dimension == 3 ? "nothing" : "table.add");
    EXPECT_EQ(refused_key(corner, dimension), dimension >= 2 ? "nothing" : "table.add");
  }
  EXPECT_EQ(refused_key(Box{{-infinity, 0, 0}, {0, 1, 0}}, 2), "nothing");
}

TEST(CheckShape, NamesTheKeyOfABadNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused_key(Box{{0, 1, 0}, {1, 1, 0}}, 2), "table.max");
  EXPECT_EQ(refused_key(Box{{0, 1, 0}, {1, 1, 0}}, 1), "nothing");
  EXPECT_EQ(refused_key(Box{{nan, 0, 0}, {1, 1, 0}}, 2), "table.min");
  EXPECT_EQ(refused_key(Box{{0, 0, 0}, {1, nan, 0}}, 2), "table.max");
  EXPECT_EQ(refused_key(Disk{{0, 0, 0}, 0}, 2), "table.radius");
  EXPECT_EQ(refused_key(Disk{{0, 0, 0}, nan}, 2), "table.radius");
  EXPECT_EQ(refused_key(Sphere{{0, 0, 0}, infinity}, 3), "table.radius");
  EXPECT_EQ(refused_key(Sphere{{0, nan, 0}, 1}, 3), "table.centre");
  EXPECT_EQ(refused_key(Cylinder{{0, 0, 0}, {0, 0, 0}, 1}, 3), "table.axis");
  EXPECT_EQ(refused_key(Cylinder{{0, 0, 0}, {0, 0, 1}, -1}, 3), "table.radius");
  EXPECT_EQ(refused_key(Cylinder{{0, 0, 0}, {0, 0, 1}, 1, 0}, 3), "table.length");
  EXPECT_EQ(refused_key(Polygon{{{0, 0}, {1, 1}}}, 2), "table.vertices");
  EXPECT_EQ(refused_key(Polygon{{{0.1, 0.1}, {0.2, 0.2}, {0.3, 0.3}}}, 2), "table.vertices");
  EXPECT_EQ(refused_key(Polygon{{{0, 0}, {1, 0}, {1, nan}}}, 2), "table.vertices");
  EXPECT_EQ(refused_key(Polygon{}, 2), "table.vertices");
}

}  // namespace
}  // namespace peristat
