#include "src/geometry/mesh_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "src/geometry/mesh_interior.hpp"
#include "src/geometry/mesh_points.hpp"

namespace peristat {
namespace {

/// A plate of nx x ny unit squares, each a quadrilateral, with the lines of its left side.
Mesh plate(int nx, int ny) {
  Mesh mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) mesh.nodes.insert(mesh.nodes.end(), {double(i), double(j), 0.0});
  Mesh::Block lines{"line", 2, {}}, squares{"quad", 4, {}};
  const auto node = [&](int i, int j) { return std::int64_t(j) * (nx + 1) + i; };
  for (int j = 0; j < ny; ++j) lines.nodes.insert(lines.nodes.end(), {node(0, j), node(0, j + 1)});
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      squares.nodes.insert(squares.nodes.end(),
                           {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
  mesh.blocks = {lines, squares};
  Mesh::Group left{"left", false, {}}, first{"first", false, {ny}};
  for (int j = 0; j < ny; ++j) left.members.push_back(j);
  mesh.groups = {left, first};
  return mesh;
}

/// A plate with a cross-shaped or L-shaped gap: elements are left out by number.
Mesh without(Mesh mesh, const std::vector<std::size_t>& elements) {
  Mesh::Block& block = mesh.blocks.back();
  Mesh::Block left{block.type, block.nodes_per_element, {}};
  for (std::size_t e = 0; e * 4 < block.nodes.size(); ++e) {
    if (std::count(elements.begin(), elements.end(), e)) continue;
    left.nodes.insert(left.nodes.end(), block.nodes.begin() + std::ptrdiff_t(4 * e),
                      block.nodes.begin() + std::ptrdiff_t(4 * e + 4));
  }
  block = left;
  mesh.groups.clear();
  return mesh;
}

/// A cube of n^3 unit hexahedra.
Mesh cube(int n) {
  Mesh mesh;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        mesh.nodes.insert(mesh.nodes.end(), {double(i), double(j), double(k)});
  const auto node = [&](int i, int j, int k) {
    return (std::int64_t(k) * (n + 1) + j) * (n + 1) + i;
  };
  Mesh::Block block{"hexahedron", 8, {}};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const int up : {0, 1})
          block.nodes.insert(block.nodes.end(),
                             {node(i, j, k + up), node(i + 1, j, k + up),
                              node(i + 1, j + 1, k + up), node(i, j + 1, k + up)});
  mesh.blocks = {block};
  return mesh;
}

std::shared_ptr<const MeshBody> body_of(const Mesh& mesh, int dimension = 2) {
  return make_mesh_body(mesh, dimension, "plate.msh");
}

/// What a mesh is refused with; "accepted" if it is not.
std::string refusal(const Mesh& mesh, int dimension = 2) {
  try {
    static_cast<void>(body_of(mesh, dimension));
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "file");
    return error.allowed();
  }
  return "accepted";
}

void expect_refusal(const Mesh& mesh, const std::vector<std::string>& words, int dimension = 2) {
  const std::string why = refusal(mesh, dimension);
  for (const std::string& word : words) EXPECT_NE(why.find(word), std::string::npos) << why;
}

TEST(MeshBody, FindsTheBoundaryOfAPlate) {
  const auto body = body_of(plate(3, 2));
  EXPECT_EQ(body->count(), 6U);
  EXPECT_EQ(body->boundary.size(), 10U);
  for (const MeshBody::Facet& facet : body->boundary) {  // counter-clockwise: the body on the left
    const Coordinates a = body->node(facet.corner[0]), b = body->node(facet.corner[1]);
    const Coordinates outward{b[1] - a[1], a[0] - b[0], 0.0};
    const Coordinates middle{(a[0] + b[0]) / 2 - 1.5, (a[1] + b[1]) / 2 - 1.0, 0.0};
    EXPECT_GT(outward[0] * middle[0] + outward[1] * middle[1], 0.0);
  }
}

TEST(MeshBody, FindsTheFacesOfACube) {
  const auto body = body_of(cube(3), 3);
  EXPECT_EQ(body->boundary.size(), 54U);
  EXPECT_NEAR(std::accumulate(body->measure.begin(), body->measure.end(), 0.0), 27.0, 1e-12);
}

TEST(MeshBody, ReordersMirroredElements) {
  Mesh mesh = plate(2, 1);
  std::reverse(mesh.blocks[1].nodes.begin(), mesh.blocks[1].nodes.begin() + 4);
  const auto body = body_of(mesh);
  EXPECT_EQ(body->boundary.size(), 6U);
  ASSERT_EQ(body->remarks.size(), 1U);
  EXPECT_NE(body->remarks[0].find("1 element of 2"), std::string::npos);
  for (const double area : body->measure) EXPECT_NEAR(area, 1.0, 1e-15);
}

TEST(MeshBody, RemarksOnFacesThatAreNoSides) {
  EXPECT_TRUE(body_of(plate(2, 1))->remarks.empty());
  Mesh mesh = plate(2, 1);
  mesh.blocks[0].nodes = {0, 5};  // across both squares
  mesh.groups.clear();
  const auto body = body_of(mesh);
  ASSERT_EQ(body->remarks.size(), 1U);
  EXPECT_NE(body->remarks[0].find("1 line"), std::string::npos);
}

TEST(MeshBody, RefusesWhatIsBroken) {
  Mesh mesh = plate(2, 2);
  mesh.blocks.pop_back();
  mesh.groups.pop_back();
  expect_refusal(mesh, {"no elements of dimension 2", "2 lines"});
  expect_refusal(plate(2, 2), {"no elements of dimension 3", "4 faces"}, 3);
  expect_refusal(cube(1), {"solid element", "dimension = 2"});
  expect_refusal(Mesh(), {"no elements at all"});

  mesh = plate(2, 2);
  mesh.blocks[1].type = "polygon";
  expect_refusal(mesh, {"element 3 ", "polygon", "not supported"});
  mesh = plate(2, 2);
  mesh.blocks[1].nodes[5] = 99;
  expect_refusal(mesh, {"element 4 ", "does not define"});
  mesh.blocks[1].nodes[5] = -1;
  expect_refusal(mesh, {"element 4 ", "does not define"});
  mesh = plate(2, 2);
  mesh.blocks[1].nodes[1] = mesh.blocks[1].nodes[0];
  expect_refusal(mesh, {"element 3 ", "node 1 at two corners"});
  mesh = plate(2, 2);
  std::swap(mesh.blocks[1].nodes[0], mesh.blocks[1].nodes[1]);
  expect_refusal(mesh, {"element 3 ", "twisted or not convex"});

  mesh = plate(2, 2);
  mesh.nodes[3] = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(mesh, {"node 2 ", "x = nan"});
  mesh.nodes[3] = 1e300;
  expect_refusal(mesh, {"node 2 ", "1e+300"});
  mesh = plate(2, 2);
  mesh.nodes[5] = 0.5;
  expect_refusal(mesh, {"z from 0 to 0.5", "one plane"});
}

TEST(MeshBody, RefusesFlatElements) {
  Mesh mesh;
  mesh.nodes = {0, 0, 0, 1, 0, 0, 2, 0, 0, 1, 1, 0};
  mesh.blocks = {{"triangle", 3, {0, 1, 3, 0, 1, 2}}};
  expect_refusal(mesh, {"element 2 ", "no area"});
}

TEST(MeshBody, RefusesInvertedElements) {
  Mesh mesh = plate(3, 3);
  mesh.nodes[3 * 5] = 3.5;  // a node in the middle goes through its neighbours' sides
  const std::string why = refusal(mesh);
  EXPECT_TRUE(why.find("twisted") != std::string::npos || why.find("overlap") != std::string::npos)
      << why;
  Mesh triangles;  // the tip of the second one lies on the same side as the first one's
  triangles.nodes = {0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 0.5, 0};
  triangles.blocks = {{"triangle", 3, {0, 1, 2, 1, 0, 3}}};
  expect_refusal(triangles, {"overlap", "element 1 ", "element 2 "});
}

TEST(MeshBody, RefusesElementsGivenTwice) {
  Mesh mesh = plate(2, 1);
  mesh.blocks.push_back(
      {"quad", 4, {mesh.blocks[1].nodes.begin(), mesh.blocks[1].nodes.begin() + 4}});
  expect_refusal(mesh, {"an element twice"});
}

TEST(MeshBody, RefusesNodesAtOnePlace) {
  Mesh mesh = plate(2, 1);  // the right square gets nodes of its own
  mesh.nodes.insert(mesh.nodes.end(), {1, 0, 0, 1, 1, 0});
  mesh.blocks[1].nodes[4] = 6;
  mesh.blocks[1].nodes[7] = 7;
  expect_refusal(mesh, {"has the position of node 2", "[[crack]]"});
}

TEST(MeshBody, RefusesHangingNodes) {
  Mesh mesh = plate(2, 1);  // the right square is halved
  mesh.nodes.insert(mesh.nodes.end(), {1, 0.5, 0, 2, 0.5, 0});
  mesh.blocks[1].nodes = {0, 1, 4, 3, 1, 2, 7, 6, 6, 7, 5, 4};
  expect_refusal(mesh, {"node 7 ", "without being one of its corners"});
}

TEST(MeshBody, RefusesOverlappingParts) {
  Mesh mesh;
  mesh.nodes = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3, 0.3, 0, 1.3, 0.3, 0, 0.3, 1.3, 0};
  mesh.blocks = {{"triangle", 3, {0, 1, 2, 3, 4, 5}}};
  expect_refusal(mesh, {"overlap: their sides cross"});
}

TEST(MeshBody, RefusesAQuadrilateralFaceBesideTriangles) {
  Mesh mesh = cube(1);
  mesh.nodes.insert(mesh.nodes.end(), {0.5, 0.5, 2.0});
  mesh.blocks.push_back({"tetra", 4, {4, 5, 7, 8, 4, 7, 6, 8}});
  expect_refusal(mesh, {"quadrilateral side of element 1 ", "triangular side"}, 3);
}

TEST(MeshBody, RefusesNamesThatCantBeUsed) {
  for (const char* const name : {"", "a|b", "a,b", "a\nb", ".", " a"}) {
    Mesh mesh = plate(2, 1);
    mesh.groups[0].name = name;
    EXPECT_NE(refusal(mesh), "accepted") << name;
  }
  Mesh mesh = plate(2, 1);
  mesh.groups[1].name = "left";
  expect_refusal(mesh, {"two groups called \"left\""});
}

TEST(MeshPoints, StandAtCentroidsWithVolumes) {
  const Points points = make_points(body_of(plate(3, 2)), PointsAt::elements, 0.5, "plate.msh");
  ASSERT_EQ(points.count(), 6);
  EXPECT_DOUBLE_EQ(points.spacing, 1.0);
  for (Index i = 0; i < 6; ++i) {
    const int number = points.source_row[std::size_t(i)] - 2;  // behind two lines
    EXPECT_NEAR(points.volume[std::size_t(i)], 0.5, 1e-15);
    EXPECT_NEAR(points.position(i)[0], number % 3 + 0.5, 1e-15);
    EXPECT_NEAR(points.position(i)[1], number / 3 + 0.5, 1e-15);
    const std::size_t first = points.elements.offset[std::size_t(i)];
    double x = 0.0;
    for (std::size_t k = 0; k < 4; ++k)
      x += points.elements.nodes[2 * std::size_t(points.elements.corners[first + k])] / 4;
    EXPECT_DOUBLE_EQ(x, points.position(i)[0]);
  }
  const std::vector<Index>& left = points.sets.at("left");
  ASSERT_EQ(left.size(), 2U);
  for (const Index i : left) EXPECT_NEAR(points.position(i)[0], 0.5, 1e-15);
  EXPECT_EQ(points.sets.at("first").size(), 1U);
}

TEST(MeshPoints, AtNodesShareTheVolume) {
  const Points points = make_points(body_of(plate(3, 2)), PointsAt::nodes, 1.0, "plate.msh");
  ASSERT_EQ(points.count(), 12);
  EXPECT_NEAR(std::accumulate(points.volume.begin(), points.volume.end(), 0.0), 6.0, 1e-14);
  for (Index i = 0; i < 12; ++i) {
    const Coordinates at = points.position(i);
    const double x = at[0] == 0.0 || at[0] == 3.0 ? 0.5 : 1.0;
    const double y = at[1] == 0.0 || at[1] == 2.0 ? 0.5 : 1.0;
    EXPECT_DOUBLE_EQ(points.volume[std::size_t(i)], x * y);
    EXPECT_EQ(points.source_row[std::size_t(i)], int(at[0] + 4 * at[1]));
  }
  EXPECT_EQ(points.sets.at("left").size(), 3U);
  EXPECT_EQ(points.sets.at("first").size(), 4U);
  EXPECT_TRUE(points.elements.empty());
}

TEST(MeshPoints, FacetsOfAGroupAreThoseOfTheBoundary) {
  const auto body = body_of(plate(3, 2));
  EXPECT_EQ(facets_of(*body, "left").size(), 2U);
  EXPECT_TRUE(facets_of(*body, "first").empty());
  EXPECT_TRUE(facets_of(*body, "nothing").empty());
}

/// 6 x 6 squares without the four in the middle; bonds over the hole leave the body.
class PlateWithHole : public testing::Test {
 protected:
  std::shared_ptr<const MeshBody> body_ = body_of(without(plate(6, 6), {14, 15, 20, 21}));
  MeshInterior interior_{body_};

  [[nodiscard]] bool leaves(const Coordinates& a, const Coordinates& b) const {
    EXPECT_EQ(interior_.leaves(a, b, {}), interior_.leaves(b, a, {}));
    return interior_.leaves(a, b, {});
  }
};

TEST_F(PlateWithHole, BondsOverTheHoleLeaveIt) {
  EXPECT_TRUE(leaves({1.5, 2.5, 0}, {4.5, 2.5, 0}));
  EXPECT_TRUE(leaves({1.5, 2.5, 0}, {2.5, 4.5, 0}));  // over a corner
  EXPECT_TRUE(leaves({1.5, 3.5, 0}, {3.5, 1.5, 0}));
  EXPECT_FALSE(leaves({1.5, 0.5, 0}, {1.5, 3.5, 0}));
  EXPECT_FALSE(leaves({1.5, 1.5, 0}, {4.5, 1.5, 0}));
  EXPECT_FALSE(leaves({0.5, 2.5, 0}, {1.5, 4.5, 0}));
}

TEST_F(PlateWithHole, BondsAlongItsSidesStay) {
  EXPECT_FALSE(leaves({2, 2, 0}, {2, 4, 0}));  // a side of the hole
  EXPECT_FALSE(leaves({2, 1, 0}, {2, 5, 0}));  // beyond it at both ends
  EXPECT_FALSE(leaves({0, 0, 0}, {6, 0, 0}));  // the outer side
  EXPECT_FALSE(leaves({1, 3, 0}, {3, 1, 0}));  // through its corner
  EXPECT_TRUE(leaves({2, 2, 0}, {4, 4, 0}));   // from corner to corner
  EXPECT_TRUE(leaves({2, 3, 0}, {3, 2, 0}));   // from side to side
  EXPECT_TRUE(leaves({2, 2, 0}, {4, 3, 0}));
  EXPECT_FALSE(leaves({2, 2, 0}, {0, 1, 0}));  // away from it
}

/// The same by many places along the bond, which must lie in a square of the mesh.
TEST_F(PlateWithHole, AgreesWithManyPlaces) {
  int cut = 0, kept = 0;
  for (const bool at_nodes : {false, true}) {
    std::vector<Coordinates> places;
    const Points points =
        make_points(body_, at_nodes ? PointsAt::nodes : PointsAt::elements, 1.0, "");
    for (Index i = 0; i < points.count(); ++i) places.push_back(points.position(i));
    for (const Coordinates& a : places) {
      for (const Coordinates& b : places) {
        if (a == b) continue;
        bool is_outside = false;
        for (int k = 1; k < 997; ++k) {
          const double x = a[0] + (b[0] - a[0]) * k / 997.0, y = a[1] + (b[1] - a[1]) * k / 997.0;
          is_outside = is_outside || (x > 2.001 && x < 3.999 && y > 2.001 && y < 3.999);
        }
        EXPECT_EQ(leaves(a, b), is_outside) << a[0] << ' ' << a[1] << ' ' << b[0] << ' ' << b[1];
        ++(is_outside ? cut : kept);
      }
    }
  }
  EXPECT_GT(cut, 100);
  EXPECT_GT(kept, 1000);
}

TEST(MeshInterior, FindsBondsOverANotchInSpace) {
  Mesh mesh = cube(3);  // without the element in the middle of the upper layer's front
  Mesh::Block& block = mesh.blocks[0];
  block.nodes.erase(block.nodes.begin() + 8 * 19, block.nodes.begin() + 8 * 20);
  const MeshInterior interior(body_of(mesh, 3));
  EXPECT_TRUE(interior.leaves({0.5, 0.5, 2.5}, {2.5, 0.5, 2.5}, {}));
  EXPECT_FALSE(interior.leaves({0.5, 1.5, 2.5}, {2.5, 1.5, 2.5}, {}));
  EXPECT_FALSE(interior.leaves({0.5, 0.5, 1.5}, {2.5, 0.5, 1.5}, {}));
  EXPECT_FALSE(interior.leaves({0, 0, 3}, {1, 0, 3}, {}));  // along edges
  EXPECT_FALSE(interior.leaves({0, 0, 0}, {3, 3, 0}, {}));  // on a face
  EXPECT_FALSE(interior.leaves({1, 0, 2}, {2, 0, 2}, {}));  // along the edge of the notch
  EXPECT_TRUE(interior.leaves({1, 0, 3}, {2, 0, 3}, {}));   // over its mouth
}

/// A bond to the image beyond a plane of symmetry is covered by the body and its image.
TEST(MeshInterior, ContinuesInImages) {
  const MeshInterior interior(body_of(plate(2, 2)));
  ImageKind mirror;
  mirror.mirror[0] = -1.0;
  EXPECT_TRUE(interior.leaves({0.5, 0.5, 0}, {-0.5, 0.5, 0}, {}));
  EXPECT_FALSE(interior.leaves({0.5, 0.5, 0}, {-0.5, 0.5, 0}, {mirror}));
}

}  // namespace
}  // namespace peristat
