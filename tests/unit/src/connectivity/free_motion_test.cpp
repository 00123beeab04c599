#include "src/connectivity/free_motion.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "src/neighbourhood/search.hpp"

namespace peristat {
namespace {

using Names = std::vector<std::string>;

/// Points of unit spacing in a box, moved by `offset` along x; bonds reach the diagonals.
struct Blocks {
  Points points;
  Bonds bonds;
  std::vector<char> prescribed;

  explicit Blocks(int dimension) {
    points.dimension = dimension;
    points.spacing = 1.0;
  }

  Blocks& add(std::array<int, 3> extent, double offset = 0.0) {
    for (int x = 0; x < extent[0]; ++x) {
      for (int y = 0; y < extent[1]; ++y) {
        for (int z = 0; z < extent[2]; ++z) {
          const double at[3] = {x + offset, double(y), double(z)};
          points.reference.insert(points.reference.end(), at, at + points.dimension);
          points.volume.push_back(1.0);
        }
      }
    }
    bonds = search_bonds(points, 1.8, 1);
    prescribed.assign(points.reference.size(), 0);
    return *this;
  }

  Blocks& hold(Index point, int component) {
    prescribed[std::size_t(point) * points.dimension + component] = 1;
    return *this;
  }

  [[nodiscard]] std::vector<FreeMotion> motions() const {
    return free_motions(points, bonds, {prescribed});
  }

  /// Of the only component that may move.
  [[nodiscard]] Names names() const {
    const auto found = motions();
    if (found.empty()) return {};
    EXPECT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].points, points.count());
    return found[0].motions;
  }
};

TEST(FreeMotions, NameEveryRigidMotionOfAFreeBody) {
  EXPECT_EQ(Blocks(1).add({4, 1, 1}).names(), (Names{"move along x"}));
  EXPECT_EQ(Blocks(2).add({4, 3, 1}).names(),
            (Names{"move along x", "move along y", "rotate about z"}));
  EXPECT_EQ(Blocks(3).add({4, 3, 2}).names(),
            (Names{"move along x", "move along y", "move along z", "rotate about x",
                   "rotate about y", "rotate about z"}));
}

TEST(FreeMotions, AreNoneOfAHeldBody) {
  EXPECT_EQ(Blocks(1).add({4, 1, 1}).hold(2, 0).names(), Names{});
  EXPECT_EQ(Blocks(2).add({4, 3, 1}).hold(0, 0).hold(0, 1).hold(11, 1).names(), Names{});
  // Three points, 3 + 2 + 1 components.
  EXPECT_EQ(Blocks(3)
                .add({3, 3, 3})
                .hold(0, 0)
                .hold(0, 1)
                .hold(0, 2)
                .hold(2, 0)
                .hold(2, 1)
                .hold(6, 0)
                .names(),
            Names{});
}

TEST(FreeMotions, LeaveTheOtherDirectionsOfASupportInOne) {
  Blocks two(2);
  two.add({3, 3, 1});
  for (Index i = 0; i < 3; ++i) two.hold(i, 0);  // the face x = 0
  EXPECT_EQ(two.names(), (Names{"move along y"}));

  Blocks three(3);
  three.add({3, 3, 3});
  for (Index i = 0; i < 9; ++i) three.hold(i, 0);
  EXPECT_EQ(three.names(), (Names{"move along y", "move along z", "rotate about x"}));
}

TEST(FreeMotions, FindAHinge) {
  EXPECT_EQ(Blocks(2).add({4, 3, 1}).hold(5, 0).hold(5, 1).names(), (Names{"rotate about z"}));
  Blocks three(3);
  three.add({3, 3, 3});
  for (int c = 0; c < 3; ++c) three.hold(0, c).hold(1, c).hold(2, c);  // the edge along z
  EXPECT_EQ(three.names(), (Names{"rotate about z"}));
}

TEST(FreeMotions, FindAHingeThatNoAxisIsAlong) {
  Blocks three(3);
  three.add({3, 3, 3});
  for (int c = 0; c < 3; ++c) three.hold(0, c).hold(26, c);  // the diagonal of the cube
  const Names names = three.names();
  ASSERT_EQ(names.size(), 1u);
  EXPECT_TRUE(names[0] == "rotate about (0.58, 0.58, 0.58)" ||
              names[0] == "rotate about (-0.58, -0.58, -0.58)")
      << names[0];
}

TEST(FreeMotions, AreToldPerPartLargestFirst) {
  Blocks two(2);
  two.add({2, 2, 1}).add({3, 2, 1}, 10.0).add({2, 2, 1}, 20.0);
  two.hold(10, 0).hold(10, 1).hold(12, 0).hold(12, 1);  // the last part
  const auto motions = two.motions();
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(motions[0].points, 6);
  EXPECT_EQ(motions[0].example, 4);
  EXPECT_EQ(motions[1].points, 4);
  EXPECT_EQ(motions[1].example, 0);
  for (const FreeMotion& part : motions) {
    EXPECT_EQ(part.motions, (Names{"move along x", "move along y", "rotate about z"}));
  }
}

TEST(FreeMotions, OfAnIsolatedPointAreTranslations) {
  Blocks two(2);
  two.add({3, 2, 1}).add({1, 1, 1}, 20.0);
  for (Index i = 0; i < 6; ++i) two.hold(i, 0).hold(i, 1);
  auto motions = two.motions();
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_EQ(motions[0].points, 1);
  EXPECT_EQ(motions[0].example, 6);
  EXPECT_EQ(motions[0].motions, (Names{"move along x", "move along y"}));
  two.hold(6, 0);
  EXPECT_EQ(two.motions().at(0).motions, (Names{"move along y"}));
  two.hold(6, 1);
  EXPECT_TRUE(two.motions().empty());
}

TEST(FreeMotions, OfAStraightRowHaveNoSpinAboutItself) {
  Blocks row(3);
  row.add({5, 1, 1});
  EXPECT_EQ(row.names(), (Names{"move along x", "move along y", "move along z", "rotate about y",
                                "rotate about z"}));
  for (int c = 0; c < 3; ++c) row.hold(0, c).hold(4, c);
  EXPECT_EQ(row.names(), Names{});
}

TEST(FreeMotions, DoNotDependOnUnitsOrPlace) {
  for (double scale : {1e-9, 1.0, 1e6}) {
    Blocks two(2);
    two.add({4, 3, 1}).hold(5, 0).hold(5, 1);
    for (double& at : two.points.reference) at = scale * (at + 1e3);
    two.points.spacing = two.points.spacing * scale;
    EXPECT_EQ(two.names(), (Names{"rotate about z"})) << scale;
  }
}

TEST(ConnectedComponents, AreNumberedByTheirLowestPoint) {
  Blocks two(2);
  two.add({1, 1, 1}, 50.0).add({2, 2, 1}).add({1, 1, 1}, 30.0);
  const Components components = connected_components(two.bonds);
  EXPECT_EQ(components.of_point, (std::vector<Index>{0, 1, 1, 1, 1, 2}));
  EXPECT_EQ(components.size, (std::vector<Index>{1, 4, 1}));
  EXPECT_EQ(components.members(), (std::vector<std::vector<Index>>{{0}, {1, 2, 3, 4}, {5}}));
}

TEST(ConnectedComponents, AreNotConnectedByBrokenBonds) {
  Blocks row(1);
  row.add({4, 1, 1});  // bonds 0-1, 1-2, 2-3
  EXPECT_EQ(connected_components(row.bonds, std::vector<char>{0, 0, 0}).size,
            (std::vector<Index>{4}));
  EXPECT_EQ(connected_components(row.bonds, std::vector<char>{0, 1, 0}).of_point,
            (std::vector<Index>{0, 0, 1, 1}));
}

}  // namespace
}  // namespace peristat
