#include "src/geometry/pixels.hpp"

#include <memory>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "src/geometry/lattice.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {
namespace {

/// Three columns and two rows over [0, 3] x [10, 12]: inside are the lower left pixel, and the
/// upper middle and right ones.
PixelImage corners() {
  Pixels pixels{{3, 2}, {1, 0, 0, 0, 1, 1}, {0, 255}, {}};
  find_borders(pixels);
  return {{}, {0, 10, 0}, {3, 12, 0}, {0, 255}, std::make_shared<const Pixels>(pixels)};
}

TEST(PixelImage, HasItsFirstRowAtTheBottom) {
  const PixelImage image = corners();
  EXPECT_TRUE(contains(image, {0.5, 10.5, 0}));
  EXPECT_FALSE(contains(image, {0.5, 11.5, 0}));
  EXPECT_FALSE(contains(image, {2.5, 10.5, 0}));
  EXPECT_TRUE(contains(image, {1.5, 11.5, 0}));
  EXPECT_TRUE(contains(image, {2.5, 11.5, 0}));
}

TEST(PixelImage, GivesABorderToTheLaterPixelWhateverTheRoundOff) {
  const PixelImage image = corners();
  for (const double off : {-1e-12, 0.0, 1e-12}) {
    EXPECT_FALSE(contains(image, {1.0 + off, 10.5, 0}));
    EXPECT_TRUE(contains(image, {1.0 + off, 11.5, 0}));
    EXPECT_FALSE(contains(image, {0.5, 11.0 + off, 0}));
    EXPECT_TRUE(contains(image, {3.0 + off, 12.0 + off, 0}));  // the last of row and column
    EXPECT_TRUE(contains(image, {0.0 + off, 10.0 + off, 0}));
  }
  EXPECT_FALSE(contains(image, {3.0 + 1e-6, 11.5, 0}));
  EXPECT_FALSE(contains(image, {-1e-6, 10.5, 0}));
}

TEST(PixelImage, HasBordersWhereTheInsideEnds) {
  EXPECT_EQ(corners().pixels->borders[0], (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(corners().pixels->borders[1], (std::vector<std::size_t>{0, 1, 2}));
  std::vector<double> t;
  append_crossings(corners(), 2, {{-1, 11.5, 0}, {1, 0, 0}}, t);
  EXPECT_EQ(t, (std::vector<double>{1, 2, 4}));
}

TEST(PixelImage, HasTheAreaOfItsPixels) {
  for (const double spacing : {0.07, 0.3, 2.5}) {
    Lattice lattice;
    lattice.dimension = 2;
    lattice.spacing = spacing;
    lattice.volumes = CellVolumes::fractional;
    lattice.shapes = {{ShapeStep::Action::add, corners()}};
    const Points points = make_points(lattice);
    EXPECT_NEAR(std::accumulate(points.volume.begin(), points.volume.end(), 0.0), 3.0, 1e-12);
  }
}

TEST(PixelImage, IsNotConvex) {
  const std::vector<ShapeStep> shapes{{ShapeStep::Action::add, corners()}};
  EXPECT_FALSE(Solid(2, shapes).holds_hull_of({{0.5, 10.5, 0}, {1.5, 11.5, 0}}));
}

}  // namespace
}  // namespace peristat
