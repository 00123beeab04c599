#include "src/geometry/convex_cell.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "src/geometry/voronoi.hpp"

namespace peristat {
namespace {

/// The cell of one place in a box: the box.
ConvexCell box_cell(int dimension, const Box& box, const Coordinates& place) {
  ConvexCell result;
  for_each_voronoi_cell(dimension, box, 1.0, {place},
                        [&](std::size_t, const ConvexCell& cell) { result = cell; });
  return result;
}

// Round shapes in closed form: a quarter of a disk, what a disk leaves, an eighth of a ball.
TEST(PartInBody, IsThatOfRoundShapes) {
  const ConvexCell square = box_cell(2, {{0, 0, 0}, {1, 1, 0}}, {0.9, 0.8, 0});
  const std::vector<ShapeStep> disk{{ShapeStep::Action::add, Disk{{0, 0, 0}, 1.0}}};
  const double quarter = std::numbers::pi / 4.0, of_centroid = 1.0 / 3.0 / quarter;
  const PartInBody inside = part_in_body(square, Solid(2, disk));
  EXPECT_FALSE(inside.is_whole);
  EXPECT_NEAR(inside.volume, quarter, 1e-11);
  EXPECT_NEAR(inside.centroid[0], of_centroid, 1e-11);
  EXPECT_NEAR(inside.centroid[1], of_centroid, 1e-11);

  std::vector<ShapeStep> hole{{ShapeStep::Action::add, Box{{0, 0, 0}, {1, 1, 0}}},
                              {ShapeStep::Action::subtract, Disk{{0, 0, 0}, 1.0}}};
  const PartInBody outside = part_in_body(square, Solid(2, hole));
  EXPECT_NEAR(outside.volume, 1.0 - quarter, 1e-11);
  EXPECT_NEAR(outside.volume * outside.centroid[0], 0.5 - 1.0 / 3.0, 1e-11);

  const ConvexCell cube = box_cell(3, {{0, 0, 0}, {1, 1, 1}}, {0.3, 0.4, 0.5});
  const std::vector<ShapeStep> ball{{ShapeStep::Action::add, Sphere{{0, 0, 0}, 1.0}}};
  const PartInBody eighth = part_in_body(cube, Solid(3, ball));
  EXPECT_NEAR(eighth.volume, std::numbers::pi / 6.0, 2e-5);
  for (const double at : eighth.centroid) EXPECT_NEAR(at, 3.0 / 8.0, 2e-5);
}

// Rays measure planes like other surfaces: half a cube below its diagonal. An error of 1e-5 is
// taken for each triangle, some of which the plane crosses.
TEST(PartInBody, IsThatOfAPrism) {
  const ConvexCell cube = box_cell(3, {{0, 0, 0}, {1, 1, 1}}, {0.3, 0.4, 0.5});
  const std::vector<ShapeStep> prism{
      {ShapeStep::Action::add, Polygon{{{-1.0, -1.0}, {2.0, -1.0}, {-1.0, 2.0}}}}};
  const PartInBody half = part_in_body(cube, Solid(3, prism));
  EXPECT_NEAR(half.volume, 0.5, 6e-5);
  EXPECT_NEAR(half.centroid[0], 1.0 / 3.0, 6e-5);
  EXPECT_NEAR(half.centroid[2], 0.5, 6e-5);
  const PartInBody rough = part_in_body(cube, Solid(3, prism), Accuracy::rough);
  EXPECT_NEAR(rough.volume, 0.5, 2e-3);
}

// A cell in one convex shape stays what it was to the last bit, also with its corners on it.
TEST(PartInBody, IsWholeInAConvexShape) {
  const ConvexCell square = box_cell(2, {{0, 0, 0}, {1, 1, 0}}, {0.9, 0.8, 0});
  const std::vector<ShapeStep> box{{ShapeStep::Action::add, Box{{0, 0, 0}, {1, 1, 0}}}},
      disk{{ShapeStep::Action::add, Disk{{0.5, 0.5, 0}, std::sqrt(0.5)}}};
  for (const auto* const steps : {&box, &disk}) {
    const PartInBody part = part_in_body(square, Solid(2, *steps));
    EXPECT_TRUE(part.is_whole);
    EXPECT_EQ(part.volume, square.volume);
    EXPECT_EQ(part.centroid, square.centroid);
  }
  // Two of them may have a gap between them that no corner tells.
  const std::vector<ShapeStep> two{{ShapeStep::Action::add, Box{{0, 0, 0}, {0.4, 1, 0}}},
                                   {ShapeStep::Action::add, Box{{0.6, 0, 0}, {1, 1, 0}}}};
  const PartInBody parts = part_in_body(square, Solid(2, two));
  EXPECT_NEAR(parts.volume, 0.8, 1e-12);
}

}  // namespace
}  // namespace peristat
