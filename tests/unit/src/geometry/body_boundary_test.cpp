#include "src/geometry/body_boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/covers.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

constexpr auto add = ShapeStep::Action::add;
constexpr auto subtract = ShapeStep::Action::subtract;
const Side left{0, -1}, right{0, 1}, bottom{1, -1}, top{1, 1};

using Shapes = std::vector<ShapeStep>;

Box box(double x0, double y0, double x1, double y1) { return {{x0, y0, 0}, {x1, y1, 0}}; }

struct Expected {
  std::string name;
  Coordinates at, normal;
};

void expect_feet(const BodyBoundary& boundary, const Shapes& shapes, const Coordinates& place,
                 double distance, const std::vector<Expected>& expected, double slack = 1e-12) {
  const auto feet = boundary.near(place, distance);
  std::string found;
  for (const Foot& foot : feet) found += name_of(foot.part, shapes) + "; ";
  ASSERT_EQ(feet.size(), expected.size()) << found;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    EXPECT_EQ(name_of(feet[k].part, shapes), expected[k].name);
    double squared = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(feet[k].at[c], expected[k].at[c], slack) << expected[k].name << " " << c;
      EXPECT_NEAR(feet[k].normal[c], expected[k].normal[c], slack) << expected[k].name << " " << c;
      squared += std::pow(expected[k].at[c] - place[c], 2);
    }
    EXPECT_NEAR(feet[k].distance, std::sqrt(squared), slack);
  }
}

TEST(BodyBoundary, OfASquareHasFourSides) {
  const Shapes shapes{{add, box(0, 0, 2, 1)}};
  const BodyBoundary boundary(2, shapes, {}, 0.1);
  expect_feet(boundary, shapes, {1.0, 0.5, 0}, 0.4, {});
  expect_feet(boundary, shapes, {1.0, 0.9, 0}, 0.4,
              {{"shape 0 side y+", {1.0, 1.0, 0}, {0, 1, 0}}});
  expect_feet(boundary, shapes, {1.9, 0.2, 0}, 0.4,
              {{"shape 0 side x+", {2.0, 0.2, 0}, {1, 0, 0}},
               {"shape 0 side y-", {1.9, 0.0, 0}, {0, -1, 0}}});
  // Closed: at the distance itself.
  expect_feet(boundary, shapes, {0.4, 0.5, 0}, 0.4,
              {{"shape 0 side x-", {0.0, 0.5, 0}, {-1, 0, 0}}});
  EXPECT_EQ(boundary.near({0.4 + 1e-7, 0.5, 0}, 0.4).size(), 0u);
  // A thin part shows both of its sides.
  expect_feet(boundary, shapes, {1.0, 0.45, 0}, 0.6,
              {{"shape 0 side y-", {1.0, 0.0, 0}, {0, -1, 0}},
               {"shape 0 side y+", {1.0, 1.0, 0}, {0, 1, 0}}});
}

TEST(BodyBoundary, OfAHolePointsIntoIt) {
  const Shapes shapes{{add, box(-1, -1, 1, 1)}, {subtract, Disk{{0.1, 0.2, 0}, 0.25}}};
  const BodyBoundary boundary(2, shapes, {}, 0.05);
  for (const double angle : {0.0, 0.3, 2.0, 3.2, 4.5, 6.28}) {
    const double c = std::cos(angle), s = std::sin(angle);
    expect_feet(boundary, shapes, {0.1 + 0.3 * c, 0.2 + 0.3 * s, 0}, 0.1,
                {{"shape 1", {0.1 + 0.25 * c, 0.2 + 0.25 * s, 0}, {-c, -s, 0}}});
  }
  EXPECT_EQ(boundary.outermost(top), 1.0);
}

TEST(BodyBoundary, OfADiskIsRoundAndHasNoFlatSide) {
  const Shapes shapes{{add, Disk{{0, 0, 0}, 2.0}}, {subtract, Disk{{0, 0, 0}, 1.0}}};
  const BodyBoundary boundary(2, shapes, {}, 0.1);
  const double d = std::numbers::sqrt2 / 2.0;
  expect_feet(boundary, shapes, {1.4 * d, 1.4 * d, 0}, 0.7,
              {{"shape 1", {d, d, 0}, {-d, -d, 0}}, {"shape 0", {2 * d, 2 * d, 0}, {d, d, 0}}});
  EXPECT_EQ(boundary.outermost(top), std::nullopt);
}

TEST(BodyBoundary, OfAHoleThatCutsASideEndsWhereTheyMeet) {
  // The circle about (0, 1) cuts the side y = 1 at x = -0.5 and 0.5.
  const Shapes shapes{{add, box(-2, 0, 2, 1)}, {subtract, Disk{{0, 1, 0}, 0.5}}};
  const BodyBoundary boundary(2, shapes, {}, 0.05);
  expect_feet(boundary, shapes, {0.0, 0.45, 0}, 0.2, {{"shape 1", {0.0, 0.5, 0}, {0, 1, 0}}});
  expect_feet(boundary, shapes, {0.6, 0.95, 0}, 0.2,
              {{"shape 0 side y+", {0.6, 1.0, 0}, {0, 1, 0}},
               {"shape 1",
                {0.5 * 0.6 / std::hypot(0.6, 0.05), 1.0 - 0.5 * 0.05 / std::hypot(0.6, 0.05), 0},
                {-0.6 / std::hypot(0.6, 0.05), 0.05 / std::hypot(0.6, 0.05), 0}}});
  // Below the gap, the nearest of the side is the corner.
  const Coordinates below{0.45, 0.75, 0};
  const auto feet = boundary.near(below, 0.3);
  ASSERT_EQ(feet.size(), 2u);
  EXPECT_EQ(feet[0].part, (ShapeSide{1, 0}));
  EXPECT_NEAR(feet[1].at[0], 0.5, 1e-12);
  EXPECT_NEAR(feet[1].at[1], 1.0, 1e-12);
  EXPECT_GT(feet[1].depth(below), 0.0);
}

TEST(BodyBoundary, OfAConcaveCornerHasBothSides) {
  for (const bool is_cut : {true, false}) {
    // An L, once cut out, once put together.
    const Shapes shapes = is_cut ? Shapes{{add, box(-1, -1, 1, 1)}, {subtract, box(0, 0, 2, 2)}}
                                 : Shapes{{add, box(-1, -1, 1, 0)}, {add, box(-1, -1, 0, 1)}};
    const BodyBoundary boundary(2, shapes, {}, 0.05);
    const std::string of_y = is_cut ? "shape 1 side y-" : "shape 0 side y+";
    const std::string of_x = is_cut ? "shape 1 side x-" : "shape 1 side x+";
    expect_feet(boundary, shapes, {0.5, -0.1, 0}, 0.2, {{of_y, {0.5, 0.0, 0}, {0, 1, 0}}});
    expect_feet(boundary, shapes, {-0.1, 0.5, 0}, 0.2, {{of_x, {0.0, 0.5, 0}, {1, 0, 0}}});
    // Into the corner, both; beyond it the side that it passes shows from in front.
    const Coordinates beside{-0.1, 0.1, 0};
    const auto feet = boundary.near(beside, 0.2);
    ASSERT_EQ(feet.size(), 2u);
    EXPECT_GT(feet[0].depth(beside), 0.0);
    EXPECT_NEAR(feet[1].depth(beside), -0.1, 1e-12);
    EXPECT_NEAR(feet[1].at[0], 0.0, 1e-12);
    EXPECT_EQ(boundary.outermost(top), 1.0);
    EXPECT_EQ(boundary.outermost(right), 1.0);
  }
}

TEST(BodyBoundary, HasNoSidesInsideTheBody) {
  // Side by side, overlapping, and a hole that is filled again.
  for (const Shapes& shapes :
       {Shapes{{add, box(0, 0, 1, 1)}, {add, box(1, 0, 2, 1)}},
        Shapes{{add, box(0, 0, 1.2, 1)}, {add, box(0.8, 0, 2, 1)}},
        Shapes{{add, box(0, 0, 2, 1)}, {subtract, Disk{{1, 0.9, 0}, 0.3}}, {add, box(0, 0, 2, 1)}},
        Shapes{{add, Polygon{{{0, 0}, {0, 1}, {1, 1}, {1, 0}}}},
               {add, Polygon{{{1, 0}, {2, 0}, {2, 1}, {1, 1}}}}}}) {
    const BodyBoundary boundary(2, shapes, {}, 0.05);
    EXPECT_TRUE(boundary.near({1.0, 0.5, 0}, 0.45).empty());
    // The common line is one face.
    const auto feet = boundary.near({1.0, 0.9, 0}, 0.45);
    ASSERT_EQ(feet.size(), 1u);
    EXPECT_NEAR(feet[0].at[0], 1.0, 1e-12);
    EXPECT_NEAR(feet[0].at[1], 1.0, 1e-12);
    EXPECT_EQ(boundary.near({1.9, 0.9, 0}, 0.3).size(), 2u);
    EXPECT_EQ(boundary.outermost(left), 0.0);
    EXPECT_EQ(boundary.outermost(right), 2.0);
  }
}

TEST(BodyBoundary, OfPolygonsGoesEitherWayRound) {
  const std::vector<std::array<double, 2>> corners{{0, 0}, {3, 0}, {3, 1}, {1, 3}, {0, 3}};
  for (const bool backwards : {false, true}) {
    Shapes shapes{{add, Polygon{corners}}};
    auto& vertices = std::get<Polygon>(shapes[0].shape).vertices;
    if (backwards) std::reverse(vertices.begin(), vertices.end());
    const BodyBoundary boundary(2, shapes, {}, 0.1);
    const double d = std::numbers::sqrt2 / 2.0;
    expect_feet(boundary, shapes, {2 - 0.1 * d, 2 - 0.1 * d, 0}, 0.2,
                {{backwards ? "shape 0 edge 1" : "shape 0 edge 2", {2, 2, 0}, {d, d, 0}}});
    expect_feet(boundary, shapes, {0.1, 1.5, 0}, 0.2,
                {{"shape 0 edge 4", {0, 1.5, 0}, {-1, 0, 0}}});
    expect_feet(boundary, shapes, {1.5, 0.1, 0}, 0.2,
                {{backwards ? "shape 0 edge 3" : "shape 0 edge 0", {1.5, 0, 0}, {0, -1, 0}}});
  }
}

TEST(BodyBoundary, OfAPolygonOfManyEdgesIsOneFace) {
  Polygon round;
  for (int k = 0; k < 48; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 48;
    round.vertices.push_back({std::cos(angle), std::sin(angle)});
  }
  const Shapes shapes{{add, round}};
  const BodyBoundary boundary(2, shapes, {}, 0.05);
  for (const double angle : {0.01, 1.3, 4.0}) {
    const auto feet = boundary.near({0.5 * std::cos(angle), 0.5 * std::sin(angle), 0}, 0.9);
    ASSERT_EQ(feet.size(), 1u);
    EXPECT_NEAR(feet[0].normal[0], std::cos(angle), 0.07);
    EXPECT_NEAR(feet[0].normal[1], std::sin(angle), 0.07);
  }
}

TEST(BodyBoundary, GoesOnFromATangentArcToALine) {
  // A stadium: the round ends touch the lines.
  const Shapes shapes{
      {add, box(0, 0, 2, 1)}, {add, Disk{{0, 0.5, 0}, 0.5}}, {add, Disk{{2, 0.5, 0}, 0.5}}};
  const BodyBoundary boundary(2, shapes, {}, 0.05);
  for (const double x : {-0.02, 0.0, 0.02}) {
    const auto feet = boundary.near({x, 0.9, 0}, 0.3);
    ASSERT_EQ(feet.size(), 1u);
    EXPECT_EQ(feet[0].part.shape, x < 0 ? 1u : feet[0].part.shape);
    EXPECT_NEAR(feet[0].normal[0], x < 0 ? x / std::hypot(x, 0.4) : 0.0, 1e-7);
  }
  EXPECT_EQ(boundary.outermost(top), 1.0);
  EXPECT_EQ(boundary.outermost(right), std::nullopt);
  // A disk that touches a side from within leaves all of it, but for the place of contact.
  const Shapes touching{{add, box(0, 0, 2, 1)}, {subtract, Disk{{1, 0.75, 0}, 0.25}}};
  const BodyBoundary other(2, touching, {}, 0.05);
  EXPECT_EQ(other.outermost(top), 1.0);
  const auto feet = other.near({0.6, 0.95, 0}, 0.1);
  ASSERT_EQ(feet.size(), 1u);
  EXPECT_NEAR(feet[0].at[0], 0.6, 1e-12);
}

TEST(BodyBoundary, CountsParallelSidesOfAStepOnce) {
  const Shapes shapes{{add, box(0, 0, 2, 1)}, {subtract, box(1, 0.9, 3, 3)}};
  const BodyBoundary boundary(2, shapes, {}, 0.05);
  expect_feet(boundary, shapes, {1.06, 0.85, 0}, 0.3,
              {{"shape 1 side y-", {1.06, 0.9, 0}, {0, 1, 0}},
               {"shape 1 side x-", {1.0, 0.9, 0}, {1, 0, 0}}});
  expect_feet(boundary, shapes, {0.96, 0.95, 0}, 0.3,
              {{"shape 1 side x-", {1.0, 0.95, 0}, {1, 0, 0}},
               {"shape 0 side y+", {0.96, 1.0, 0}, {0, 1, 0}}});
  EXPECT_EQ(boundary.outermost(top), 1.0);
}

TEST(BodyBoundary, TellsWhatIsOutermost) {
  // A dome on a box has no flat top; a half-space that is taken away leaves one.
  const Shapes dome{{add, box(-1, 0, 1, 1)}, {add, Disk{{0, 1, 0}, 0.5}}};
  EXPECT_EQ(BodyBoundary(2, dome, {}, 0.1).outermost(top), std::nullopt);
  EXPECT_EQ(BodyBoundary(2, dome, {}, 0.1).outermost(bottom), 0.0);
  Shapes cut = dome;
  cut.push_back({subtract, Box{{-infinity, 1.25, 0}, {infinity, infinity, 0}}});
  const BodyBoundary boundary(2, cut, {}, 0.1);
  ASSERT_TRUE(boundary.outermost(top).has_value());
  EXPECT_DOUBLE_EQ(*boundary.outermost(top), 1.25);
  const auto feet = boundary.near({0.1, 1.2, 0}, 0.1);
  ASSERT_EQ(feet.size(), 1u);
  EXPECT_TRUE(boundary.is_on(feet[0], top));
  const auto shoulder = boundary.near({0.9, 0.95, 0}, 0.06);
  ASSERT_EQ(shoulder.size(), 1u);
  EXPECT_FALSE(boundary.is_on(shoulder[0], top));
}

TEST(BodyBoundary, CoversAreNoneAndSidesGoOnBesideThem) {
  const Shapes shapes{{add, box(0, 0, 2, 1)}};
  const BodyBoundary boundary(2, shapes, {{left, 0.0, 0.6, {}}}, 0.1);
  expect_feet(boundary, shapes, {0.1, 0.5, 0}, 0.3, {});
  expect_feet(boundary, shapes, {0.1, 0.9, 0}, 0.3,
              {{"shape 0 side y+", {0.1, 1.0, 0}, {0, 1, 0}}});
  expect_feet(boundary, shapes, {-0.5, 0.9, 0}, 0.3,
              {{"shape 0 side y+", {-0.5, 1.0, 0}, {0, 1, 0}}});
  expect_feet(boundary, shapes, {-0.5, 0.05, 0}, 0.3,
              {{"shape 0 side y-", {-0.5, 0.0, 0}, {0, -1, 0}}});
  // As far as the cover: beyond it the nearest is its end.
  expect_feet(boundary, shapes, {-0.7, 0.9, 0}, 0.3,
              {{"shape 0 side y+", {-0.6, 1.0, 0}, {0, 1, 0}}});
  EXPECT_EQ(boundary.outermost(left), std::nullopt);
  EXPECT_EQ(boundary.outermost(right), 2.0);
  EXPECT_EQ(boundary.outermost(top), 1.0);
}

TEST(BodyBoundary, APartOfASideMayBeCovered) {
  const Shapes shapes{{add, box(0, 0, 2, 1)}};
  const auto where = [](const Coordinates& place) { return place[0] > 0.73; };
  const BodyBoundary boundary(2, shapes, {{top, 1.0, 0.6, where}}, 0.1);
  expect_feet(boundary, shapes, {0.5, 0.9, 0}, 0.2,
              {{"shape 0 side y+", {0.5, 1.0, 0}, {0, 1, 0}}});
  expect_feet(boundary, shapes, {1.0, 0.9, 0}, 0.2, {});
  expect_feet(boundary, shapes, {0.8, 0.9, 0}, 0.2,
              {{"shape 0 side y+", {0.73, 1.0, 0}, {0, 1, 0}}}, 1e-6);
  expect_feet(boundary, shapes, {1.9, 1.3, 0}, 0.2,
              {{"shape 0 side x+", {2.0, 1.3, 0}, {1, 0, 0}}});
  EXPECT_EQ(boundary.outermost(top), 1.0);
}

TEST(BodyBoundary, SlantedSidesBesideACoverAreRefused) {
  const std::vector<std::array<double, 2>> wider{{0, 0}, {2, 0}, {1.5, 1}, {0, 1}};
  const std::vector<std::array<double, 2>> narrower{{0, 0}, {1.5, 0}, {2, 1}, {0, 1}};
  for (const auto& corners : {wider, narrower}) {
    const Shapes shapes{{add, Polygon{corners}}};
    EXPECT_THROW(BodyBoundary(2, shapes, {{top, 1.0, 0.3, {}}}, 0.05), InputError);
    // Where the cover does not reach them they don't matter.
    const auto where = [](const Coordinates& place) { return place[0] < 1.0; };
    EXPECT_NO_THROW(BodyBoundary(2, shapes, {{top, 1.0, 0.3, where}}, 0.05));
    EXPECT_NO_THROW(BodyBoundary(2, shapes, {{left, 0.0, 0.3, {}}}, 0.05));
  }
}

TEST(BodyBoundary, IsTheSameAtAnyScaleAndFarAway) {
  for (const double scale : {1e-9, 1.0, 1e6}) {
    for (const double away : {0.0, 1e4}) {
      const Coordinates at{away * scale, -away * scale, 0};
      const auto place = [&](double x, double y) {
        return Coordinates{at[0] + scale * x, at[1] + scale * y, 0};
      };
      const Shapes shapes{{add, Box{place(-2, 0), place(2, 1)}},
                          {subtract, Disk{place(0, 1), 0.5 * scale}}};
      const BodyBoundary boundary(2, shapes, {}, 0.05 * scale);
      const auto feet = boundary.near(place(0.6, 0.95), 0.2 * scale);
      ASSERT_EQ(feet.size(), 2u) << scale << " " << away;
      EXPECT_NEAR(feet[0].distance / scale, 0.05, 1e-10);
      EXPECT_NEAR(feet[1].distance / scale, std::hypot(0.6, 0.05) - 0.5, 1e-10);
      const auto below = boundary.near(place(0.45, 0.75), 0.3 * scale);
      ASSERT_EQ(below.size(), 2u);
      EXPECT_NEAR((below[1].at[0] - at[0]) / scale, 0.5, 1e-10);
    }
  }
}

TEST(BodyBoundary, InThreeDimensions) {
  const Shapes shapes{{add, Box{{-1, -1, -1}, {1, 1, 1}}},
                      {subtract, Cylinder{{0, 0, 0}, {0, 0, 2}, 0.25, infinity}},
                      {subtract, Sphere{{0.6, 0.6, 0.6}, 0.2}}};
  const BodyBoundary boundary(3, shapes, {}, 0.05);
  expect_feet(boundary, shapes, {0.5, -0.5, 0.9}, 0.2,
              {{"shape 0 side z+", {0.5, -0.5, 1.0}, {0, 0, 1}}});
  expect_feet(boundary, shapes, {0.9, -0.95, 0.2}, 0.2,
              {{"shape 0 side y-", {0.9, -1.0, 0.2}, {0, -1, 0}},
               {"shape 0 side x+", {1.0, -0.95, 0.2}, {1, 0, 0}}});
  expect_feet(boundary, shapes, {0.18, 0.24, 0.1}, 0.1,
              {{"shape 1", {0.15, 0.2, 0.1}, {-0.6, -0.8, 0}}});
  const double d = 1.0 / std::sqrt(3.0);
  expect_feet(boundary, shapes, {0.6 - 0.25 * d, 0.6 - 0.25 * d, 0.6 - 0.25 * d}, 0.1,
              {{"shape 2", {0.6 - 0.2 * d, 0.6 - 0.2 * d, 0.6 - 0.2 * d}, {d, d, d}}});
  EXPECT_EQ(boundary.outermost({2, 1}), 1.0);
  // Of an added cylinder the round side and the ends.
  const Shapes rod{{add, Cylinder{{0, 0, 0}, {1, 0, 0}, 0.5, 4.0}}};
  const BodyBoundary of_rod(3, rod, {}, 0.05);
  expect_feet(of_rod, rod, {1.9, 0.24, 0.32}, 0.2,
              {{"shape 0", {1.9, 0.3, 0.4}, {0, 0.6, 0.8}},
               {"shape 0 upper end", {2.0, 0.24, 0.32}, {1, 0, 0}}});
  EXPECT_EQ(of_rod.outermost({0, -1}), -2.0);
  EXPECT_EQ(of_rod.outermost({1, 1}), std::nullopt);
}

TEST(BodyBoundary, InThreeDimensionsFindsTheRestOfAFaceThatIsCut) {
  // The circle about (0, 1) in x, y cuts the plane y = 1 at x = -0.5 and 0.5, along z.
  const Shapes shapes{{add, Box{{-2, 0, -1}, {2, 1, 1}}},
                      {subtract, Cylinder{{0, 1, 0}, {0, 0, 1}, 0.5, infinity}}};
  const BodyBoundary boundary(3, shapes, {}, 0.05);
  const Coordinates below{0.45, 0.75, 0.1};
  const auto feet = boundary.near(below, 0.3);
  ASSERT_EQ(feet.size(), 2u);
  EXPECT_EQ(feet[0].part, (ShapeSide{1, 0}));
  EXPECT_EQ(feet[1].part, (ShapeSide{0, 3}));
  EXPECT_NEAR(feet[1].at[0], 0.5, 1e-6);
  EXPECT_NEAR(feet[1].at[1], 1.0, 1e-6);
  EXPECT_NEAR(feet[1].at[2], 0.1, 1e-4);
  EXPECT_NEAR(feet[1].distance, std::hypot(0.05, 0.25), 1e-7);
  // Beyond an edge of a box the nearest place is on the edge.
  const Shapes step{{add, Box{{-1, -1, -1}, {1, 1, 0}}}, {add, Box{{-1, -1, -1}, {0, 1, 1}}}};
  const BodyBoundary concave(3, step, {}, 0.05);
  const Coordinates beside{-0.1, 0.3, 0.12};
  const auto of_corner = concave.near(beside, 0.2);
  ASSERT_EQ(of_corner.size(), 2u);
  EXPECT_NEAR(of_corner[0].at[2], 0.12, 1e-12);
  EXPECT_NEAR(of_corner[1].at[0], 0.0, 1e-6);
  EXPECT_NEAR(of_corner[1].at[2], 0.0, 1e-12);
  EXPECT_NEAR(of_corner[1].depth(beside), -0.12, 1e-12);
  // The whole of a sphere's cap: its rim is the nearest to what is above it.
  const Shapes cap{{add, Sphere{{0, 0, 0}, 1.0}}, {subtract, Box{{-2, -2, 0.6}, {2, 2, 2}}}};
  const BodyBoundary flat(3, cap, {}, 0.05);
  const auto of_cap = flat.near({0.3, 0.0, 0.55}, 0.7);
  ASSERT_EQ(of_cap.size(), 2u);
  EXPECT_EQ(of_cap[0].part, (ShapeSide{1, 4}));
  EXPECT_EQ(of_cap[0].normal, (Coordinates{0, 0, 1}));
  EXPECT_NEAR(of_cap[1].at[0], 0.8, 1e-6);
  EXPECT_NEAR(of_cap[1].at[2], 0.6, 1e-6);
}

TEST(BodyBoundary, InThreeDimensionsHasCovers) {
  const Shapes shapes{{add, Box{{0, 0, 0}, {2, 1, 1}}}};
  const BodyBoundary boundary(3, shapes, {{{2, -1}, 0.0, 0.4, {}}}, 0.1);
  expect_feet(boundary, shapes, {1.0, 0.5, 0.1}, 0.2, {});
  expect_feet(boundary, shapes, {1.0, 0.9, 0.1}, 0.2,
              {{"shape 0 side y+", {1.0, 1.0, 0.1}, {0, 1, 0}}});
  expect_feet(boundary, shapes, {1.0, 0.9, -0.3}, 0.2,
              {{"shape 0 side y+", {1.0, 1.0, -0.3}, {0, 1, 0}}});
  EXPECT_EQ(boundary.outermost({2, -1}), std::nullopt);
  EXPECT_EQ(boundary.outermost({2, 1}), 1.0);
}

TEST(BodyBoundary, OfALatticeIsNotBelowItsLayers) {
  Lattice lattice;
  lattice.spacing = 0.1;
  lattice.shapes = {{add, box(0, 0, 1.0, 0.8)}, {subtract, Disk{{0.5, 0.4, 0}, 0.2}}};
  lattice.layers = {{"left", left, 6, ""}, {"top", top, 3, "x > 0.5"}};
  std::vector<Coordinates> places;
  for (const Site& site : body_sites(lattice)) places.push_back(site.place);
  const auto covers = covers_of(lattice, places);
  ASSERT_EQ(covers.size(), 2u);
  EXPECT_EQ(covers[0].side, left);
  EXPECT_NEAR(covers[0].face, 0.0, 1e-12);
  EXPECT_NEAR(covers[0].depth, 0.6, 1e-12);
  EXPECT_NEAR(covers[1].face, 0.8, 1e-12);
  const BodyBoundary boundary(2, lattice.shapes, covers, 0.1);
  expect_feet(boundary, lattice.shapes, {-0.55, 0.75, 0}, 0.3,
              {{"shape 0 side y+", {-0.55, 0.8, 0}, {0, 1, 0}}});
  expect_feet(boundary, lattice.shapes, {0.75, 0.75, 0}, 0.2, {});
  lattice.shapes = {{add, Disk{{0, 0, 0}, 0.6}}};
  EXPECT_THROW((void)covers_of(lattice, places), InputError);
}

TEST(BodyBoundary, OfOneDimensionIsRefused) {
  const Shapes shapes{{add, box(0, 0, 1, 0)}};
  EXPECT_THROW(BodyBoundary(1, shapes, {}, 0.1), InputError);
}

/// Boxes, round shapes and polygons, added and taken away at random.
Shapes random_shapes(int dimension, tests::Random& random) {
  const double high = dimension == 3 ? 1.0 : 0.0;
  Shapes shapes{{add, Box{{-1, -1, -high}, {1, 1, high}}}};
  for (int k = 0; k < 6; ++k) {
    const Coordinates at{random.number(), random.number(), high * random.number()};
    const double size = 0.15 + 0.2 * (1.0 + random.number());
    ShapeStep step{random.number() < 0.2 ? add : subtract, {}};
    const int kind = k % 3;
    if (kind == 0) {
      Box of{at, at};
      for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
        of.min[c] -= size;
        of.max[c] += 0.7 * size;
      }
      step.shape = of;
    } else if (kind == 1 && dimension == 2) {
      step.shape = Disk{at, size};
    } else if (kind == 1) {
      step.shape = Sphere{at, size};
    } else if (dimension == 2) {
      step.shape = Polygon{
          {{at[0], at[1]}, {at[0] + size, at[1] + 0.3 * size}, {at[0] + 0.2 * size, at[1] + size}}};
    } else {
      step.shape =
          Cylinder{at, {random.number(), random.number(), random.number()}, 0.5 * size, 3.0 * size};
    }
    shapes.push_back(step);
  }
  return shapes;
}

/// Shortest way from a place out of the body, along many directions.
double way_out(const Solid& body, int dimension, const Coordinates& place, int directions,
               tests::Random& random) {
  double shortest = infinity;
  for (int k = 0; k < directions; ++k) {
    Coordinates along{std::cos(2.0 * std::numbers::pi * k / directions),
                      std::sin(2.0 * std::numbers::pi * k / directions), 0.0};
    if (dimension == 3) along = {random.number(), random.number(), random.number()};
    const double length = std::hypot(along[0], along[1], along[2]);
    for (double& component : along) component /= length;
    std::vector<double> t;
    const Line line{place, along};
    body.append_crossings(line, t);
    std::sort(t.begin(), t.end());
    for (const double at : t) {
      if (at <= 0.0 || body.contains(line.at(at + 1e-6))) continue;
      shortest = std::min(shortest, at);
      break;
    }
  }
  return shortest;
}

TEST(BodyBoundary, OfAnyBodyIsWhereItEnds) {
  for (const int dimension : {2, 3}) {
    tests::Random random(std::uint64_t(10 + dimension));
    int places = 0, far = 0;
    for (int body = 0; body < (dimension == 2 ? 40 : 20); ++body) {
      const Shapes shapes = random_shapes(dimension, random);
      const Solid solid(dimension, shapes);
      const BodyBoundary boundary(dimension, shapes, {}, 0.02);
      for (int k = 0; k < 25; ++k) {
        const Coordinates place{random.number(), random.number(),
                                dimension == 3 ? random.number() : 0.0};
        if (!solid.contains(place)) continue;
        const auto feet = boundary.near(place, 0.4);
        for (const Foot& foot : feet) {
          Coordinates below = foot.at, above = foot.at;
          double length = 0.0;
          for (std::size_t c = 0; c < 3; ++c) {
            below[c] -= 1e-6 * foot.normal[c];
            above[c] += 1e-6 * foot.normal[c];
            length += foot.normal[c] * foot.normal[c];
          }
          EXPECT_NEAR(length, 1.0, 1e-12);
          // On an edge one of them may stand beside it.
          const double off = std::abs(foot.distance - std::abs(foot.depth(place)));
          EXPECT_TRUE(off > 1e-9 || (solid.contains(below) && !solid.contains(above)))
              << "body " << body << " of " << dimension << "D";
        }
        const double out = way_out(solid, dimension, place, dimension == 2 ? 720 : 1000, random);
        const double nearest = feet.empty() ? infinity : feet.front().distance;
        ++places;
        if (out > 0.4) {
          ++far;
          EXPECT_TRUE(nearest > 0.4 || out < 0.45);
          continue;
        }
        // A way in one of the directions is longer by the curvature of the distance.
        EXPECT_LE(nearest, out + 1e-6) << "body " << body << " of " << dimension << "D";
        EXPECT_GE(nearest, out - (dimension == 2 ? 0.01 : 0.06))
            << "body " << body << " of " << dimension << "D";
      }
    }
    EXPECT_GT(places - far, 150);
  }
}

}  // namespace
}  // namespace peristat
