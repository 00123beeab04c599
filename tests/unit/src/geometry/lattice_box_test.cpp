#include "src/geometry/lattice_box.hpp"

#include <gtest/gtest.h>

#include "src/geometry/lattice.hpp"

namespace peristat {
namespace {

Lattice rectangle(const Spacing& spacing) {
  Lattice lattice;
  lattice.dimension = 2;
  lattice.spacing = spacing;
  lattice.shapes.push_back(
      {ShapeStep::Action::add,
       Box{{-0.3, 1.0}, {-0.3 + 7 * spacing.along(0), 1.0 + 5 * spacing.along(1)}}});
  return lattice;
}

LatticeBox box_of(const Points& points) {
  std::string why_not;
  const auto box = lattice_box(points, why_not);
  EXPECT_TRUE(box) << why_not;
  return box.value_or(LatticeBox{});
}

/// Points that are so many spacings apart have places that are.
void expect_places(const Points& points, const LatticeBox& box, double tolerance) {
  ASSERT_EQ(box.place.size(), std::size_t(points.count()));
  ASSERT_GT(points.count(), 1);
  const auto first = box.numbers(box.place[0]);
  for (Index i = 0; i < points.count(); ++i) {
    const auto at = box.numbers(box.place[i]);
    for (int c = 0; c < points.dimension; ++c) {
      ASSERT_GE(at[c], 0);
      ASSERT_LT(at[c], box.extent[c]);
      EXPECT_NEAR((points.position(i)[c] - points.position(0)[c]) / points.spacing.along(c),
                  double(at[c] - first[c]), tolerance);
    }
  }
}

TEST(LatticeBox, HoldsARectangleOfOblongCells) {
  const Points points = make_points(rectangle(Spacing({0.1, 0.25}, 2)));
  const LatticeBox box = box_of(points);
  EXPECT_EQ(box.dimension, 2);
  EXPECT_EQ(box.extent, (std::array<Index, 3>{7, 5, 1}));
  EXPECT_EQ(box.count(), 35U);
  expect_places(points, box, 1e-12);
}

TEST(LatticeBox, IsAsLargeAsWhatIsLeftOfTheShapes) {
  Lattice lattice = rectangle(0.1);
  lattice.shapes.push_back({ShapeStep::Action::subtract, Box{{-1.0, 0.0}, {-0.1, 9.0}}});
  lattice.shapes.push_back({ShapeStep::Action::subtract, Disk{{0.15, 1.25}, 0.11}});
  const Points points = make_points(lattice);
  const LatticeBox box = box_of(points);
  EXPECT_EQ(box.extent, (std::array<Index, 3>{5, 5, 1}));
  EXPECT_LT(points.count(), 25);
  expect_places(points, box, 1e-12);
}

TEST(LatticeBox, KnowsPlacesOfTurnedAndPerturbedLattices) {
  Lattice turned = rectangle(0.1);
  turned.angle = 30.0;
  const Points points = make_points(turned);
  const LatticeBox box = box_of(points);
  EXPECT_GT(box.count(), std::size_t(points.count()));
  // Neighbours of the lattice stand in places beside each other, in any direction.
  Index neighbours = 0;
  for (Index i = 0; i < points.count(); ++i) {
    for (Index j = 0; j < i; ++j) {
      const Coordinates a = points.position(i), b = points.position(j);
      const double apart = std::hypot(a[0] - b[0], a[1] - b[1]) / 0.1;
      const auto p = box.numbers(box.place[i]), q = box.numbers(box.place[j]);
      EXPECT_NEAR(apart, std::hypot(double(p[0] - q[0]), double(p[1] - q[1])), 1e-9);
      neighbours += apart < 1.1;
    }
  }
  EXPECT_GT(neighbours, 30);

  Lattice perturbed = rectangle(0.1);
  perturbed.perturbation = 0.3;
  const Points shifted = make_points(perturbed);
  expect_places(shifted, box_of(shifted), 0.61);
}

TEST(LatticeBox, IsNoneForCloudsAndSharedPlaces) {
  std::string why_not;
  Points points = make_points(rectangle(0.1));
  Points cloud = points;
  cloud.lattice.reset();
  EXPECT_FALSE(lattice_box(cloud, why_not));
  EXPECT_EQ(why_not, "the points do not lie on a lattice");
  points.reference[2] = points.reference[0] + 1e-3;
  points.reference[3] = points.reference[1];
  EXPECT_FALSE(lattice_box(points, why_not));
  EXPECT_EQ(why_not, "several points share a lattice site");
  Points far = make_points(rectangle(0.1));
  far.reference[0] = 1e6;
  far.reference[3] = -1e6;
  EXPECT_FALSE(lattice_box(far, why_not));
  EXPECT_EQ(why_not, "the box around the points has more than 2^31 lattice sites");
}

}  // namespace
}  // namespace peristat
