#include "src/geometry/point_set.hpp"

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// Five points at x = 0 ... 4, y = x / 10.
Points row() {
  Points points;
  points.dimension = 2;
  points.spacing = 1.0;
  for (int i = 0; i < 5; ++i) {
    points.reference.insert(points.reference.end(), {double(i), 0.1 * i});
    points.volume.push_back(1.0);
  }
  return points;
}

std::string refused_key(const SetRule& rule) {
  try {
    (void)select(row(), rule);
  } catch (const InputError& error) {
    return error.key();
  }
  return "nothing";
}

TEST(Select, TakesThePointsWhereTheExpressionIsTrue) {
  EXPECT_EQ(select(row(), {"s", "x > 1.5*spacing && y < 0.35", {}}), (std::vector<Index>{2, 3}));
  EXPECT_EQ(select(row(), {"s", "x > 10", {}}), (std::vector<Index>{}));
  EXPECT_EQ(select(row(), {"s", "1", {}}).size(), 5u);
}

TEST(Select, TakesThePointsInTheShape) {
  EXPECT_EQ(select(row(), {"s", "", Box{{1, 0, 0}, {3, 0.2, 0}}}), (std::vector<Index>{1, 2}));
}

TEST(Select, NeedsBothIfBothAreGiven) {
  EXPECT_EQ(select(row(), {"s", "x != 2", Disk{{2, 0.2, 0}, 1.1}}), (std::vector<Index>{1, 3}));
}

TEST(Select, EvaluatesTheExpressionOnlyInsideTheShape) {
  EXPECT_EQ(select(row(), {"s", "1/x > 0.4", Box{{0.5, 0, 0}, {9, 9, 0}}}),
            (std::vector<Index>{1, 2}));
  EXPECT_EQ(refused_key({"s", "1/x > 0.4 ? 1/x : 1/x", {}}), "where");  // infinite at x = 0
}

TEST(Select, RefusesARuleThatCannotBeUsed) {
  EXPECT_EQ(refused_key({"s", "", {}}), "where");
  EXPECT_EQ(refused_key({"s", "x >", {}}), "where");
  EXPECT_EQ(refused_key({"s", "z > 0", {}}), "where");
  EXPECT_EQ(refused_key({"s", "load > 0", {}}), "where");
  EXPECT_EQ(refused_key({"s", "", Disk{{0, 0, 0}, -1}}), "shape.radius");
  EXPECT_EQ(refused_key({"s", "", Sphere{{0, 0, 0}, 1}}), "shape");
}

}  // namespace
}  // namespace peristat
