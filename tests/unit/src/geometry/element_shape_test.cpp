#include "src/geometry/element_shape.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

using Kind = MeshElements::Kind;
using Corners = std::vector<Coordinates>;

/// Corners of the elements on the unit square and cube, in VTK's order.
Corners plain(Kind kind) {
  switch (kind) {
    case Kind::triangle:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    case Kind::quadrilateral:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    case Kind::tetrahedron:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case Kind::hexahedron:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
              {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    case Kind::wedge:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    default:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  }
}

class ElementShapeTest : public testing::TestWithParam<Kind> {
 protected:
  [[nodiscard]] const ElementShape& shape() const { return shape_of(GetParam()); }

  /// Corners moved at random, the plain ones in 2D within the plane.
  [[nodiscard]] Corners shaken(double by) const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-by, by);
    Corners corners = plain(GetParam());
    for (Coordinates& corner : corners)
      for (int c = 0; c < shape().dimension; ++c) corner[std::size_t(c)] += shift(random);
    return corners;
  }
};

TEST_P(ElementShapeTest, HasTheVolumeOfTheUnitElement) {
  const double expected = GetParam() == Kind::triangle || GetParam() == Kind::wedge ? 1.0 / 2.0
                          : GetParam() == Kind::tetrahedron                         ? 1.0 / 6.0
                          : GetParam() == Kind::pyramid                             ? 1.0 / 3.0
                                                                                    : 1.0;
  const ElementMeasure of = measure_of(shape(), plain(GetParam()));
  EXPECT_NEAR(of.measure, expected, 1e-15);
  EXPECT_GT(of.least, 0.0);
}

/// An affine map multiplies the volume by its determinant and moves the centroid along.
TEST_P(ElementShapeTest, FollowsAffineMaps) {
  const bool is_plane = shape().dimension == 2;
  const std::array<Coordinates, 3> map{{{1.3, 0.2, is_plane ? 0.0 : -0.4},
                                        {0.1, 0.9, is_plane ? 0.0 : 0.3},
                                        {is_plane ? 0.0 : 0.2, is_plane ? 0.0 : -0.1, 1.0}}};
  const auto mapped = [&](const Coordinates& at) {
    return Coordinates{dot(map[0], at) + 1e3, dot(map[1], at) - 5.0,
                       is_plane ? 0.0 : dot(map[2], at)};
  };
  Corners corners = shaken(0.1), moved;
  for (const Coordinates& corner : corners) moved.push_back(mapped(corner));
  const ElementMeasure before = measure_of(shape(), corners), after = measure_of(shape(), moved);
  const double determinant = dot(cross(map[0], map[1]), map[2]);
  EXPECT_NEAR(after.measure, determinant * before.measure, 1e-12);
  EXPECT_LT(length(minus(after.centroid, mapped(before.centroid))), 1e-11);
}

/// By the divergence theorem over the sides, each the mean of its two divisions into triangles,
/// which is exact for bilinear faces:  V = 1/d sum x . n dA.
TEST_P(ElementShapeTest, HasTheVolumeWithinItsSides) {
  const Corners corners = shaken(0.15);
  double sum = 0.0;
  for (const std::vector<int>& side : shape().sides) {
    const auto at = [&](int k) { return corners[std::size_t(side[std::size_t(k)])]; };
    const auto of_triangle = [&](int a, int b, int c) {
      return dot(cross(at(a), at(b)), at(c)) / 6.0;
    };
    if (side.size() == 2) {
      sum += cross(at(0), at(1))[2] / 2.0;
    } else if (side.size() == 3) {
      sum += of_triangle(0, 1, 2);
    } else {
      sum += 0.5 * (of_triangle(0, 1, 2) + of_triangle(0, 2, 3) + of_triangle(0, 1, 3) +
                    of_triangle(1, 2, 3));
    }
  }
  EXPECT_NEAR(measure_of(shape(), corners).measure, sum, 1e-14);
}

TEST_P(ElementShapeTest, MirroredOrderHasTheOppositeVolume) {
  const Corners corners = shaken(0.1);
  Corners mirrored;
  for (const int k : shape().mirrored) mirrored.push_back(corners[std::size_t(k)]);
  const ElementMeasure of = measure_of(shape(), corners), other = measure_of(shape(), mirrored);
  EXPECT_NEAR(other.measure, -of.measure, 1e-15);
  EXPECT_LT(length(minus(other.centroid, of.centroid)), 1e-14);
  EXPECT_NEAR(other.largest, -of.least, 1e-14);
}

INSTANTIATE_TEST_SUITE_P(All, ElementShapeTest,
                         testing::Values(Kind::triangle, Kind::quadrilateral, Kind::tetrahedron,
                                         Kind::hexahedron, Kind::wedge, Kind::pyramid));

/// Frusta of height 1 between parallel ends A and B: V = (A + sqrt(AB) + B)/3,
/// z = (A + 2 sqrt(AB) + 3 B) / (4 (A + sqrt(AB) + B)); the trapezium of sides a, b: z = (a + 2 b)
/// / (3 (a + b)).
TEST(ElementShape, HasVolumeAndCentroidOfFrusta) {
  Corners hexahedron = plain(Kind::hexahedron), wedge = plain(Kind::wedge);
  for (Corners* const corners : {&hexahedron, &wedge}) {
    for (Coordinates& corner : *corners)
      if (corner[2] == 1.0) corner = {0.5 * corner[0], 0.5 * corner[1], 1.0};
  }
  const ElementMeasure cut = measure_of(shape_of(Kind::hexahedron), hexahedron);
  EXPECT_NEAR(cut.measure, 1.75 / 3.0, 1e-15);
  EXPECT_NEAR(cut.centroid[2], 2.75 / (4.0 * 1.75), 1e-15);
  const ElementMeasure roof = measure_of(shape_of(Kind::wedge), wedge);
  EXPECT_NEAR(roof.measure, 0.875 / 3.0, 1e-15);
  EXPECT_NEAR(roof.centroid[2], 1.375 / (4.0 * 0.875), 1e-15);
  const Corners trapezium{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_NEAR(measure_of(shape_of(Kind::quadrilateral), trapezium).centroid[1], 4.0 / 9.0, 1e-15);
  const Coordinates of_pyramid = measure_of(shape_of(Kind::pyramid), plain(Kind::pyramid)).centroid;
  EXPECT_LT(length(minus(of_pyramid, {0.375, 0.375, 0.25})), 1e-15);
  const Coordinates of_tetrahedron =
      measure_of(shape_of(Kind::tetrahedron), plain(Kind::tetrahedron)).centroid;
  EXPECT_LT(length(minus(of_tetrahedron, {0.25, 0.25, 0.25})), 1e-15);
}

TEST(ElementShape, KnowsTypesOfSecondOrderByTheirCorners) {
  ASSERT_NE(shape_of_type("hexahedron20"), nullptr);
  EXPECT_EQ(shape_of_type("hexahedron20")->kind, Kind::hexahedron);
  EXPECT_EQ(shape_of_type("tetra10")->corners, 4);
  EXPECT_EQ(shape_of_type("polygon7"), nullptr);
}

TEST(ElementShape, TwistedElementsHaveDeterminantsOfBothSigns) {
  const Corners bow{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const ElementMeasure twisted = measure_of(shape_of(Kind::quadrilateral), bow);
  EXPECT_LT(twisted.least, 0.0);
  EXPECT_GT(twisted.largest, 0.0);
  const Corners dent{{0, 0, 0}, {1, 0, 0}, {0.2, 0.2, 0}, {0, 1, 0}};
  EXPECT_LT(measure_of(shape_of(Kind::quadrilateral), dent).least, 0.0);
}

}  // namespace
}  // namespace peristat
