#include "src/geometry/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr auto add = ShapeStep::Action::add;
constexpr auto subtract = ShapeStep::Action::subtract;

/// Plate of 6 x 4 cells, [0, 0.6] x [0, 0.4].
Lattice plate() {
  Lattice lattice;
  lattice.spacing = 0.1;
  lattice.cross_section = 0.02;
  lattice.shapes = {{add, Box{{0, 0, 0}, {0.6, 0.4, 0}}}};
  return lattice;
}

/// Place in half spacings from the origin, free of round-off.
using HalfSteps = std::array<long, 3>;

HalfSteps half_steps(const Points& points, Index point) {
  HalfSteps steps{};
  for (int c = 0; c < 3; ++c) {
    const double exact = points.position(point)[c] / points.spacing * 2;
    steps[c] = std::lround(exact);
    EXPECT_NEAR(exact, steps[c], 1e-9);
  }
  return steps;
}

std::set<HalfSteps> places(const Points& points, const std::vector<Index>& members) {
  std::set<HalfSteps> result;
  for (const Index point : members) result.insert(half_steps(points, point));
  EXPECT_EQ(result.size(), members.size()) << "two points at one place";
  return result;
}

std::set<HalfSteps> places(const Points& points) {
  std::vector<Index> all(points.count());
  std::iota(all.begin(), all.end(), 0);
  return places(points, all);
}

std::set<HalfSteps> block(HalfSteps first, HalfSteps last) {
  std::set<HalfSteps> result;
  for (long x = first[0]; x <= last[0]; x += 2) {
    for (long y = first[1]; y <= last[1]; y += 2) {
      for (long z = first[2]; z <= last[2]; z += 2) result.insert({x, y, z});
    }
  }
  return result;
}

std::set<HalfSteps> both(std::set<HalfSteps> a, const std::set<HalfSteps>& b) {
  a.insert(b.begin(), b.end());
  return a;
}

TEST(Lattice, StandsAtCellCentres) {
  const Points points = make_points(plate());
  EXPECT_EQ(points.dimension, 2);
  EXPECT_EQ(points.spacing, 0.1);
  EXPECT_EQ(places(points), block({1, 1, 0}, {11, 7, 0}));
}

TEST(Lattice, StandsOnNodesIncludingTheFarSide) {
  Lattice lattice = plate();
  lattice.origin = LatticeOrigin::nodes;
  EXPECT_EQ(places(make_points(lattice)), block({0, 0, 0}, {12, 8, 0}));
  // Lengths whose ratio to the spacing falls on either side of a whole number.
  for (const int count : {3, 7, 29, 49, 93, 1000}) {
    lattice.dimension = 1;
    lattice.spacing = 0.1 / count;
    lattice.shapes = {{add, Box{{0.2, 0, 0}, {0.3, 0, 0}}}};
    EXPECT_EQ(make_points(lattice).count(), count + 1);
    lattice.origin = LatticeOrigin::cell_centres;
    EXPECT_EQ(make_points(lattice).count(), count);
    lattice.origin = LatticeOrigin::nodes;
  }
}

TEST(Lattice, FillsTheVolumeOfItsBodyInEveryDimension) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    Lattice lattice;
    lattice.dimension = dimension;
    lattice.spacing = 0.1;
    lattice.cross_section = dimension == 3 ? 1.0 : 0.02;
    Box box{{-1, -0.5, 2}, {1, 0.5, 2.3}};
    for (int c = dimension; c < 3; ++c) box.min[c] = box.max[c] = 0.0;
    lattice.shapes = {{add, box}};
    const Points points = make_points(lattice);
    const double size[] = {2.0, 2.0 * 1.0, 2.0 * 1.0 * 0.3};
    const int count[] = {20, 20 * 10, 20 * 10 * 3};
    EXPECT_EQ(points.count(), count[dimension - 1]);
    const double volume = std::accumulate(points.volume.begin(), points.volume.end(), 0.0);
    EXPECT_NEAR(volume, size[dimension - 1] * lattice.cross_section, 1e-12);
  }
}

TEST(Lattice, AddsAndSubtractsInOrder) {
  const Box left{{0, 0, 0}, {0.3, 0.4, 0}}, corner{{0, 0, 0}, {0.1, 0.1, 0}};
  Lattice lattice = plate();
  lattice.shapes.push_back({subtract, left});
  EXPECT_EQ(places(make_points(lattice)), block({7, 1, 0}, {11, 7, 0}));
  lattice.shapes.push_back({add, corner});
  EXPECT_EQ(places(make_points(lattice)), both(block({7, 1, 0}, {11, 7, 0}), {{1, 1, 0}}));
}

TEST(Lattice, LosesThePointsOnTheBoundaryOfAHole) {
  Lattice lattice = plate();
  // (0.25, 0.15) is at 0.05 from four points only; its radius reaches just these.
  lattice.shapes.push_back({subtract, Disk{{0.25, 0.15, 0}, 0.1}});
  std::set<HalfSteps> expected = block({1, 1, 0}, {11, 7, 0});
  for (const HalfSteps& gone : {HalfSteps{5, 3, 0}, {3, 3, 0}, {7, 3, 0}, {5, 1, 0}, {5, 5, 0}}) {
    ASSERT_EQ(expected.erase(gone), 1u);
  }
  EXPECT_EQ(places(make_points(lattice)), expected);
}

TEST(Lattice, CoversAllAddedShapesAnchoredOnTheFirst) {
  Lattice lattice = plate();
  // Its own cells would be shifted; the first shape's lattice has points at -0.15 and -0.05.
  lattice.shapes.push_back({add, Box{{-0.17, 0.12, 0}, {0, 0.28, 0}}});
  EXPECT_EQ(places(make_points(lattice)),
            both(block({1, 1, 0}, {11, 7, 0}), block({-3, 3, 0}, {-1, 5, 0})));
}

TEST(Lattice, MeetsTheOriginExactly) {
  Lattice lattice;
  lattice.spacing = 1e-3;
  lattice.origin = LatticeOrigin::nodes;
  lattice.shapes = {{add, Box{{-0.027, -0.031, 0}, {0.027, 0.031, 0}}}};
  const Points points = make_points(lattice);
  EXPECT_EQ(points.count(), 55 * 63);
  EXPECT_EQ(std::count(points.reference.begin(), points.reference.end(), 0.0), 55 + 63);
}

TEST(Lattice, IsNumberedAlongItsShortestDirectionFirst) {
  const Points points = make_points(plate());
  for (Index point = 0; point < points.count(); ++point) {
    EXPECT_EQ(half_steps(points, point), (HalfSteps{1 + 2 * (point / 4), 1 + 2 * (point % 4), 0}));
  }
}

TEST(Layer, CopiesTheOutermostPlaneOutwards) {
  Lattice lattice = plate();
  lattice.layers = {{"top", {1, 1}, 3, ""}, {"left", {0, -1}, 1, ""}};
  const Points points = make_points(lattice);
  const auto top = block({1, 9, 0}, {11, 13, 0}), left = block({-1, 1, 0}, {-1, 7, 0});
  EXPECT_EQ(places(points, points.sets.at("top")), top);
  EXPECT_EQ(places(points, points.sets.at("left")), left);  // beside the body, not beside the top
  EXPECT_EQ(places(points), both(both(block({1, 1, 0}, {11, 7, 0}), top), left));
  EXPECT_TRUE(std::is_sorted(points.sets.at("top").begin(), points.sets.at("top").end()));
  for (const double volume : points.volume) EXPECT_DOUBLE_EQ(volume, 0.1 * 0.1 * 0.02);
}

TEST(Layer, StandsInFrontOfTheOutermostPlaneOnly) {
  Lattice lattice = plate();
  lattice.shapes.push_back({subtract, Box{{0.2, 0.3, 0}, {0.6, 0.4, 0}}});
  lattice.layers = {{"top", {1, 1}, 2, ""}};
  const Points points = make_points(lattice);
  EXPECT_EQ(places(points, points.sets.at("top")), block({1, 9, 0}, {3, 11, 0}));
}

TEST(Layer, WorksInThreeDimensions) {
  Lattice lattice;
  lattice.dimension = 3;
  lattice.spacing = 0.5;
  lattice.shapes = {{add, Box{{0, 0, 0}, {1, 1.5, 2}}}};
  lattice.layers = {{"bottom", {2, -1}, 2, "y > spacing"}};
  const Points points = make_points(lattice);
  EXPECT_EQ(places(points, points.sets.at("bottom")), block({1, 3, -3}, {3, 5, -1}));
}

TEST(Layer, KeepsThePartWhereItsExpressionIsTrue) {
  Lattice lattice = plate();
  lattice.layers = {{"corner", {1, 1}, 1, "x < 2*spacing"}, {"rest", {1, 1}, 1, "x >= 2*spacing"}};
  const Points points = make_points(lattice);
  EXPECT_EQ(places(points, points.sets.at("corner")), block({1, 9, 0}, {3, 9, 0}));
  EXPECT_EQ(places(points, points.sets.at("rest")), block({5, 9, 0}, {11, 9, 0}));
}

TEST(Layer, SharesAPointWithALayerAtTheSamePlace) {
  Lattice lattice = plate();
  lattice.layers = {{"thick", {1, 1}, 2, ""}, {"thin", {1, 1}, 1, "x < 2*spacing"}};
  const Points points = make_points(lattice);
  EXPECT_EQ(places(points), block({1, 1, 0}, {11, 11, 0}));  // which also finds doubles
  EXPECT_EQ(places(points, points.sets.at("thin")), block({1, 9, 0}, {3, 9, 0}));
}

TEST(Layer, JoinsLayersOfOneName) {
  Lattice lattice = plate();
  lattice.layers = {{"ends", {0, -1}, 1, ""}, {"ends", {0, 1}, 1, ""}};
  const Points points = make_points(lattice);
  EXPECT_EQ(places(points, points.sets.at("ends")),
            both(block({-1, 1, 0}, {-1, 7, 0}), block({13, 1, 0}, {13, 7, 0})));
}

TEST(Perturbation, MovesTheBodyWithinItsRangeAndNotTheLayers) {
  Lattice lattice = plate();
  lattice.layers = {{"top", {1, 1}, 3, ""}};
  const Points regular = make_points(lattice);
  lattice.perturbation = 0.2;
  const Points moved = make_points(lattice);
  EXPECT_EQ(moved.sets, regular.sets);
  const auto& top = regular.sets.at("top");
  double largest = 0.0;
  for (std::size_t k = 0; k < regular.reference.size(); ++k) {
    const double shift = moved.reference[k] - regular.reference[k];
    if (std::binary_search(top.begin(), top.end(), Index(k / 2))) {
      EXPECT_EQ(shift, 0.0);
    } else {
      EXPECT_NE(shift, 0.0);
      largest = std::max(largest, std::abs(shift));
    }
  }
  EXPECT_LE(largest, 0.2 * 0.1 * (1 + 1e-12));
  EXPECT_GT(largest, 0.8 * 0.2 * 0.1);  // 48 draws all below have the probability 0.8^48 = 2e-5
}

TEST(Perturbation, IsTheSameForASeedOnEveryMachine) {
  Lattice lattice = plate();
  const Points regular = make_points(lattice);
  lattice.perturbation = 0.3;
  lattice.seed = 5489;  // default of mt19937_64, whose 10000th number the C++ standard prescribes
  const Points moved = make_points(lattice);
  std::mt19937_64 generator;
  for (std::size_t k = 0; k < moved.reference.size(); ++k) {
    const double from_zero_to_one = std::ldexp(double(generator()), -64);
    const double expected = 0.3 * 0.1 * (2 * from_zero_to_one - 1);
    EXPECT_NEAR(moved.reference[k] - regular.reference[k], expected, 1e-15);
  }
  EXPECT_EQ(make_points(lattice).reference, moved.reference);
  lattice.seed = 2;
  EXPECT_NE(make_points(lattice).reference, moved.reference);
}

TEST(EstimatePoints, IsExactForABoxWithLayersAndAnUpperBoundOtherwise) {
  Lattice lattice = plate();
  lattice.layers = {{"top", {1, 1}, 3, ""}};
  EXPECT_EQ(estimate_points(lattice), 6 * 4 + 6 * 3);
  EXPECT_EQ(estimate_points(lattice), make_points(lattice).count());
  lattice.shapes.push_back({subtract, Disk{{0.3, 0.2, 0}, 0.15}});
  lattice.shapes.push_back({add, Box{{-0.3, 0, 0}, {0, 0.1, 0}}});
  EXPECT_GT(estimate_points(lattice), make_points(lattice).count());
}

TEST(EstimatePoints, NeitherOverflowsNorTakesTime) {
  Lattice lattice = plate();
  lattice.dimension = 3;
  lattice.shapes = {{add, Box{{0, 0, 0}, {1, 1, 1}}}};
  lattice.layers = {{"top", {1, 1}, std::numeric_limits<int>::max(), ""}};
  lattice.spacing = 1e-6;
  EXPECT_NEAR(estimate_points(lattice) / (1e18 + 1e12 * 2147483647.0), 1.0, 1e-5);
  lattice.spacing = 1e-300;
  EXPECT_EQ(estimate_points(lattice), infinity);
  for (const double spacing : {0.0, -1.0, std::nan("")}) {
    lattice.spacing = spacing;
    EXPECT_EQ(estimate_points(lattice), infinity);
  }
  EXPECT_EQ(estimate_points(Lattice{}), infinity);
}

/// Key of the error that refuses the plate after a change.
template <class Change>
std::string refused_key(Change change) {
  Lattice lattice = plate();
  lattice.layers = {{"top", {1, 1}, 3, ""}, {"left", {0, -1}, 3, ""}};
  change(lattice);
  try {
    (void)make_points(lattice);
  } catch (const InputError& error) {
    EXPECT_FALSE(error.allowed().empty());
    return error.key();
  }
  return "nothing";
}

TEST(MakePoints, NamesTheKeyOfWhatCannotBeUsed) {
  const double nan = std::nan("");
  EXPECT_EQ(refused_key([](Lattice&) {}), "nothing");
  for (const double spacing : {0.0, -0.1, nan, infinity, 1e-9, 1e-200}) {
    EXPECT_EQ(refused_key([&](Lattice& l) { l.spacing = spacing; }), "spacing");
  }
  for (const double cross_section : {0.0, -1.0, nan, infinity}) {
    EXPECT_EQ(refused_key([&](Lattice& l) { l.cross_section = cross_section; }), "cross_section");
  }
  for (const double perturbation : {-0.1, 0.5, nan}) {
    EXPECT_EQ(refused_key([&](Lattice& l) { l.perturbation = perturbation; }), "perturbation");
  }
  EXPECT_EQ(refused_key([](Lattice& l) { l.dimension = 4; }), "dimension");
  EXPECT_EQ(refused_key([](Lattice& l) { l.shapes.clear(); }), "shapes");
  EXPECT_EQ(refused_key([](Lattice& l) { l.shapes[0].action = subtract; }), "shapes[0].action");
  EXPECT_EQ(refused_key([](Lattice& l) {
              l.shapes.push_back({subtract, Disk{{}, -1}});
            }),
            "shapes[1].radius");
  EXPECT_EQ(refused_key([](Lattice& l) {
              l.shapes.push_back({subtract, Sphere{{}, 1}});
            }),
            "shapes[1].action");
  EXPECT_EQ(refused_key([](Lattice& l) {
              l.shapes[0].shape = Box{{0, 0, 0}, {infinity, 1, 0}};
            }),
            "shapes[0].action");
  // Nothing is left of the body, or the body fits between the lattice's points.
  EXPECT_EQ(refused_key([](Lattice& l) {
              l.shapes.push_back({subtract, l.shapes[0].shape});
            }),
            "shapes");
  EXPECT_EQ(refused_key([](Lattice& l) { l.spacing = 2.0; }), "shapes");
}

TEST(MakePoints, RefusesAnUnboundedBody) {
  Lattice lattice;
  lattice.dimension = 3;
  lattice.spacing = 0.1;
  for (const Shape& shape :
       {Shape(Polygon{{{0, 0}, {1, 0}, {1, 1}}}), Shape(Cylinder{{}, {0, 0, 1}, 1})}) {
    lattice.shapes = {{add, shape}};
    EXPECT_THROW((void)make_points(lattice), InputError);
    lattice.shapes = {{add, Box{{-1, -1, -1}, {2, 2, 2}}}, {subtract, shape}};
    const int count = make_points(lattice).count();
    EXPECT_GT(count, 0);
    EXPECT_LT(count, 27000);
  }
}

TEST(MakePoints, NamesTheKeyOfALayerThatCannotBeUsed) {
  EXPECT_EQ(refused_key([](Lattice& l) { l.layers[1].where = "x > 7"; }), "layers[1].where");
  EXPECT_EQ(refused_key([](Lattice& l) { l.layers[1].where = "x >"; }), "layers[1].where");
  EXPECT_EQ(refused_key([](Lattice& l) { l.layers[0].where = "z > 7"; }), "layers[0].where");
  EXPECT_EQ(refused_key([](Lattice& l) { l.layers[1].thickness = 0; }), "layers[1].thickness");
  EXPECT_EQ(refused_key([](Lattice& l) { l.layers[1].side = {2, 1}; }), "layers[1].side");
  EXPECT_EQ(refused_key([](Lattice& l) { l.layers[1].name = ""; }), "layers[1].name");
}

}  // namespace
}  // namespace peristat
