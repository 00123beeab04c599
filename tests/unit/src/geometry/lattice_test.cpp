#include "src/geometry/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

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

// ---- Spacings that differ

TEST(Spacings, OfOneValueAreThatValueToTheLastBit) {
  Lattice lattice = plate();
  lattice.layers = {{"top", {1, 1}, 3, ""}};
  const Points one = make_points(lattice);
  lattice.spacing = Spacing({0.1, 0.1, 0.0}, 2);
  const Points listed = make_points(lattice);
  EXPECT_EQ(one.reference, listed.reference);
  EXPECT_EQ(one.volume, listed.volume);
  EXPECT_EQ(double(one.spacing), double(listed.spacing));
}

TEST(Spacings, MakeCellsOfTheirProduct) {
  Lattice lattice = plate();
  lattice.spacing = Spacing({0.1, 0.2, 0.0}, 2);
  lattice.layers = {{"top", {1, 1}, 2, ""}, {"left", {0, -1}, 2, ""}};
  const Points points = make_points(lattice);
  EXPECT_EQ(points.count(), 6 * 2 + 6 * 2 + 2 * 2);
  EXPECT_NEAR(points.spacing, std::sqrt(0.1 * 0.2), 1e-15);
  EXPECT_FALSE(points.spacing.is_square());
  for (const double volume : points.volume) EXPECT_NEAR(volume, 0.1 * 0.2 * 0.02, 1e-16);
  for (const Index point : points.sets.at("top")) {
    const double above = points.position(point)[1] - 0.4;
    EXPECT_NEAR(std::min(std::abs(above - 0.1), std::abs(above - 0.3)), 0.0, 1e-12);
  }
  for (const Index point : points.sets.at("left")) {
    const double outside = -points.position(point)[0];
    EXPECT_NEAR(std::min(std::abs(outside - 0.05), std::abs(outside - 0.15)), 0.0, 1e-12);
  }
}

// ---- Turned lattices

TEST(TurnedLattice, WholeTurnsAreNoneToTheLastBit) {
  Lattice lattice = plate();
  lattice.perturbation = 0.2;
  lattice.layers = {{"top", {1, 1}, 3, ""}};
  const Points still = make_points(lattice);
  for (const double angle : {360.0, -360.0, -0.0}) {
    lattice.angle = angle;
    EXPECT_EQ(make_points(lattice).reference, still.reference);
  }
}

TEST(TurnedLattice, StandsOnItsTurnedPlacesAndNowhereElse) {
  for (const int dimension : {2, 3}) {
    Lattice lattice = plate();
    lattice.dimension = dimension;
    lattice.shapes = {{add, Box{{0.03, 0.05, 0}, {0.63, 0.45, 0.3}}}};
    lattice.angle = 25.0;
    const double c = std::cos(25.0 * M_PI / 180.0), s = std::sin(25.0 * M_PI / 180.0);
    std::set<HalfSteps> expected, found;
    for (int x = -20; x <= 20; ++x) {
      for (int y = -20; y <= 20; ++y) {
        const double u = 0.03 + (x + 0.5) * 0.1, v = 0.05 + (y + 0.5) * 0.1;
        const double at[] = {c * u - s * v, s * u + c * v};
        const bool inside = at[0] >= 0.03 && at[0] <= 0.63 && at[1] >= 0.05 && at[1] <= 0.45;
        for (int z = 0; inside && z < (dimension == 3 ? 3 : 1); ++z) expected.insert({x, y, z});
      }
    }
    const Points points = make_points(lattice);
    for (Index point = 0; point < points.count(); ++point) {
      const Coordinates at = points.position(point);
      const double u = (c * at[0] + s * at[1] - 0.03) / 0.1 - 0.5;
      const double v = (c * at[1] - s * at[0] - 0.05) / 0.1 - 0.5;
      const double w = dimension == 3 ? at[2] / 0.1 - 0.5 : 0.0;
      EXPECT_NEAR(u, std::round(u), 1e-9);
      EXPECT_NEAR(v, std::round(v), 1e-9);
      found.insert({std::lround(u), std::lround(v), std::lround(w)});
    }
    EXPECT_EQ(found, expected);
    EXPECT_GE(estimate_points(lattice), points.count());
  }
}

TEST(TurnedLattice, OfAQuarterIsTheSquareLatticeOfASymmetricBody) {
  Lattice lattice = plate();
  lattice.shapes = {{add, Box{{-0.3, -0.2, 0}, {0.3, 0.2, 0}}}};
  lattice.layers = {{"top", {1, 1}, 3, ""}, {"left", {0, -1}, 2, ""}};
  const Points still = make_points(lattice);
  for (const double angle : {90.0, -90.0, 180.0, 270.0}) {
    lattice.angle = angle;
    const Points turned = make_points(lattice);
    EXPECT_EQ(places(turned), places(still));
    EXPECT_EQ(places(turned, turned.sets.at("top")), places(still, still.sets.at("top")));
    EXPECT_EQ(places(turned, turned.sets.at("left")), places(still, still.sets.at("left")));
  }
}

TEST(TurnedLattice, HasLayersInFrontOfTheFace) {
  Lattice lattice = plate();
  lattice.spacing = 0.02;
  lattice.angle = 33.0;
  lattice.layers = {{"top", {1, 1}, 3, ""}, {"corner", {1, 1}, 2, "x < 0.1"}};
  const Points points = make_points(lattice);
  Index above = 0;
  for (Index point = 0; point < points.count(); ++point) above += points.position(point)[1] > 0.4;
  EXPECT_EQ(Index(points.sets.at("top").size()), above);
  EXPECT_NEAR(double(above), 30 * 3, 10);  // as many cells as fit, up to those at the rim
  for (const Index point : points.sets.at("top")) {
    const Coordinates at = points.position(point);
    EXPECT_TRUE(at[0] >= 0.0 && at[0] <= 0.6 && at[1] > 0.4 && at[1] <= 0.46 + 1e-12);
  }
  for (const Index point : points.sets.at("corner")) {
    EXPECT_TRUE(points.position(point)[0] < 0.1 && points.position(point)[1] <= 0.44 + 1e-12);
  }
}

TEST(TurnedLattice, RefusesALayerOnARoundSide) {
  Lattice lattice = plate();
  lattice.spacing = 0.02;
  lattice.angle = 10.0;
  lattice.shapes = {{add, Disk{{0.0, 0.0, 0}, 0.3}}};
  lattice.layers = {{"top", {1, 1}, 3, ""}};
  try {
    (void)make_points(lattice);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "layers[0].side");
  }
}

TEST(TurnedLattice, OfASlenderBodyTakesNoMoreTimeThanItsPoints) {
  Lattice lattice = plate();
  lattice.spacing = 1.0;
  lattice.angle = 45.0;
  lattice.shapes = {{add, Box{{0, 0, 0}, {1e5, 2, 0}}}};
  EXPECT_NEAR(make_points(lattice).count(), 2e5, 2e4);
  EXPECT_LT(estimate_points(lattice), 1e6);  // the box along the lattice's axes has 5e9 places
}

// ---- Fractional volumes

double volume_of(const Points& points, const std::vector<Index>& members) {
  double sum = 0.0;
  for (const Index point : members) sum += points.volume[std::size_t(point)];
  return sum;
}

double volume_of(const Points& points) {
  return std::accumulate(points.volume.begin(), points.volume.end(), 0.0);
}

TEST(FractionalVolumes, OfWholeCellsAreTheCellsToTheLastBit) {
  Lattice lattice = plate();
  lattice.layers = {{"top", {1, 1}, 3, ""}, {"left", {0, -1}, 2, "y < 0.25"}};
  const Points whole = make_points(lattice);
  lattice.volumes = CellVolumes::fractional;
  const Points cut = make_points(lattice);
  EXPECT_EQ(whole.reference, cut.reference);
  EXPECT_EQ(whole.volume, cut.volume);
  EXPECT_EQ(whole.sets, cut.sets);
}

struct Body {
  int dimension;
  std::vector<ShapeStep> shapes;
  double volume;  // or area
};

const double pi = std::acos(-1.0);
const std::vector<Body> bodies{
    {1, {{add, Box{{0, 0, 0}, {0.93, 0, 0}}}}, 0.93},
    {2,
     {{add, Box{{0, 0, 0}, {0.61, 0.37, 0}}}, {subtract, Box{{0.2, 0.1, 0}, {0.31, 9, 0}}}},
     0.61 * 0.37 - 0.11 * 0.27},
    {2,
     {{add, Box{{-1, -0.5, 0}, {1, 0.5, 0}}}, {subtract, Disk{{0.013, 0.021, 0}, 0.3}}},
     2 - pi * 0.09},
    {2, {{add, Polygon{{{0, 0}, {1, 0.2}, {0.3, 0.9}}}}}, 0.42},
    {2, {{add, Disk{{0, 0, 0}, 1}}, {subtract, Disk{{0, 0, 0}, 0.6}}}, pi * 0.64},
    {3, {{add, Box{{0, 0, 0}, {0.6, 0.5, 0.44}}}}, 0.6 * 0.5 * 0.44},
    {3, {{add, Sphere{{0.02, 0.01, 0}, 0.4}}}, 4.0 / 3.0 * pi * 0.064},
    {3,
     {{add, Box{{0, 0, 0}, {1, 1, 0.5}}}, {subtract, Cylinder{{.5, .5, .2}, {0, 0, 1}, .3}}},
     0.5 - pi * 0.09 * 0.5}};

// To round-off of some hundred cells, and to 1e-5 of a cell, of which there are tens, at corners
// where shapes cross and in 3D; with nodes at the corner of the first shape as with cells there.
TEST(FractionalVolumes, AddUpToTheBodyWhereverTheLatticeStands) {
  for (const Body& body : bodies) {
    for (const double angle : {0.0, 17.0, 45.0}) {
      if (body.dimension == 1 && angle != 0.0) continue;
      for (const LatticeOrigin origin : {LatticeOrigin::cell_centres, LatticeOrigin::nodes}) {
        Lattice lattice = plate();
        lattice.dimension = body.dimension;
        lattice.cross_section = body.dimension == 3 ? 1.0 : 0.02;
        lattice.spacing = Spacing({0.1, 0.12, 0.09}, body.dimension);
        lattice.shapes = body.shapes;
        lattice.angle = angle;
        lattice.origin = origin;
        lattice.volumes = CellVolumes::fractional;
        const Points points = make_points(lattice);
        EXPECT_NEAR(volume_of(points) / (body.volume * lattice.cross_section), 1.0,
                    body.dimension < 3 && body.shapes.size() == 1 ? 1e-9 : 1e-5);
        EXPECT_GE(estimate_points(lattice), points.count());
        for (const double volume : points.volume) EXPECT_GT(volume, 0.0);
      }
    }
  }
}

// By hand: a slanted cut through the middles of cells.
TEST(FractionalVolumes, StandAtTheirCellsPlaces) {
  Lattice lattice = plate();
  lattice.spacing = 1.0;
  lattice.shapes = {{add, Polygon{{{0, 0}, {3, 0}, {3, 3}, {0, 3}}}},
                    {subtract, Polygon{{{3, 1}, {3, 4}, {0, 4}}}}};
  lattice.volumes = CellVolumes::fractional;
  const Points points = make_points(lattice);  // what is below x + y = 4
  ASSERT_EQ(points.count(), 8);
  int halves = 0;
  for (Index point = 0; point < points.count(); ++point) {
    const Coordinates at = points.position(point);
    const double share = points.volume[std::size_t(point)] / points.cell_volume;
    EXPECT_EQ(at[0], std::floor(at[0]) + 0.5);
    EXPECT_EQ(at[1], std::floor(at[1]) + 0.5);
    if (share == 1.0) continue;
    EXPECT_NEAR(share, 0.5, 1e-12);
    ++halves;
  }
  EXPECT_EQ(halves, 2);
}

TEST(FractionalVolumes, GiveSliversToTheirNeighbours) {
  Lattice lattice = plate();
  lattice.volumes = CellVolumes::fractional;
  lattice.shapes = {{add, Box{{0, 0, 0}, {0.6, 0.4005, 0}}}};  // 1/200 of a cell on top
  const Points points = make_points(lattice);
  EXPECT_EQ(points.count(), 6 * 4);
  EXPECT_NEAR(volume_of(points), 0.6 * 0.4005 * 0.02, 1e-15);
  int larger = 0;
  for (Index point = 0; point < points.count(); ++point) {
    const double share = points.volume[std::size_t(point)] / points.cell_volume;
    if (share == 1.0) continue;
    EXPECT_NEAR(share, 1.005, 1e-12);
    EXPECT_NEAR(points.position(point)[1], 0.35, 1e-12);
    ++larger;
  }
  EXPECT_EQ(larger, 6);
}

// Corners of layers on a turned lattice are right to 1e-5 of a cell, of which there are ten.
TEST(FractionalVolumes, OfLayersFillWhatIsInFrontOfTheFace) {
  for (const double angle : {0.0, 30.0, 45.0}) {
    for (const LatticeOrigin origin : {LatticeOrigin::cell_centres, LatticeOrigin::nodes}) {
      Lattice lattice = plate();
      lattice.angle = angle;
      lattice.origin = origin;
      lattice.volumes = CellVolumes::fractional;
      lattice.shapes = {{add, Box{{0, 0, 0}, {0.63, 0.47, 0}}}};
      lattice.layers = {{"top", {1, 1}, 3, ""}, {"left", {0, -1}, 2, ""}, {"near", {1, 1}, 1, ""}};
      const Points points = make_points(lattice);
      const double top = 0.63 * 0.3 * 0.02, left = 0.47 * 0.2 * 0.02;
      EXPECT_NEAR(volume_of(points, points.sets.at("top")) / top, 1.0, 1e-6);
      EXPECT_NEAR(volume_of(points, points.sets.at("left")) / left, 1.0, 1e-6);
      EXPECT_NEAR(volume_of(points) / (0.63 * 0.47 * 0.02 + top + left), 1.0, 1e-6);
      EXPECT_LT(points.sets.at("near").size(), points.sets.at("top").size());
      std::set<std::vector<double>> apart;
      for (Index point = 0; point < points.count(); ++point) {
        const Coordinates at = points.position(point);
        apart.insert({at[0], at[1]});
      }
      EXPECT_EQ(Index(apart.size()), points.count()) << "two points at one place";
      EXPECT_GE(estimate_points(lattice), points.count());
    }
  }
}

TEST(MakePoints, NamesTheKeyOfALatticeThatCannotBeUsed) {
  for (const double angle : {400.0, -361.0, std::nan(""), infinity}) {
    EXPECT_EQ(refused_key([&](Lattice& l) { l.angle = angle; }), "angle");
  }
  EXPECT_EQ(refused_key([](Lattice& l) { l.spacing = Spacing({0.1, -0.1, 0}, 2); }), "spacing");
  Lattice bar;
  bar.dimension = 1;
  bar.spacing = 0.1;
  bar.angle = 10.0;
  bar.shapes = {{add, Box{{0, 0, 0}, {1, 0, 0}}}};
  EXPECT_THROW((void)make_points(bar), InputError);
}

/// A square with a hole and a layer, its inner cells' corners shifted.
Lattice with_perturbed_cells(double perturbation, double angle) {
  Lattice lattice;
  lattice.spacing = Spacing({0.1, 0.08, 0.0}, 2);
  lattice.angle = angle;
  lattice.shapes = {{ShapeStep::Action::add, Box{{-0.8, -0.8, 0}, {0.8, 0.8, 0}}},
                    {ShapeStep::Action::subtract, Disk{{0.1, 0.2, 0}, 0.3}}};
  if (angle == 0.0) lattice.layers = {{"left", {0, -1}, 2, ""}};
  lattice.cell_perturbation = perturbation;
  return lattice;
}

// The cells fill the body as before: area and first moments stay what they were, to round-off of a
// few hundred terms. Corners inside move, those on the boundary don't.
TEST(PerturbedCells, FillTheBody) {
  for (const double angle : {0.0, 25.0}) {
    const Points still = make_points(with_perturbed_cells(0.0, angle));
    const Points moved = make_points(with_perturbed_cells(0.24, angle));
    ASSERT_EQ(still.count(), moved.count());
    double area = 0.0, change = 0.0, farthest = 0.0, least = 1.0, most = 1.0;
    Coordinates moment{};
    for (Index i = 0; i < still.count(); ++i) {
      const Coordinates a = still.position(i), b = moved.position(i);
      area += still.volume[i];
      change += moved.volume[i] - still.volume[i];
      for (std::size_t c = 0; c < 2; ++c) {
        moment[c] += moved.volume[i] * b[c] - still.volume[i] * a[c];
      }
      farthest = std::max(farthest, std::hypot(b[0] - a[0], b[1] - a[1]));
      least = std::min(least, moved.volume[i] / still.volume[i]);
      most = std::max(most, moved.volume[i] / still.volume[i]);
    }
    EXPECT_NEAR(change, 0.0, 1e-14 * area);
    EXPECT_NEAR(moment[0], 0.0, 1e-14 * area);
    EXPECT_NEAR(moment[1], 0.0, 1e-14 * area);
    EXPECT_GT(farthest, 0.01);
    EXPECT_LT(farthest, 0.03);  // a quarter of a diagonal
    EXPECT_GT(most, 1.2);
    EXPECT_LT(least, 0.8);
    EXPECT_EQ(moved.cell_volume, still.volume.front());
  }
}

TEST(PerturbedCells, LeaveLayersAndFollowFromTheSeed) {
  Lattice lattice = with_perturbed_cells(0.2, 0.0);
  const Points still = make_points(with_perturbed_cells(0.0, 0.0));
  const Points one = make_points(lattice), again = make_points(lattice);
  EXPECT_EQ(one.reference, again.reference);
  EXPECT_EQ(one.volume, again.volume);
  lattice.seed = 2;
  EXPECT_NE(make_points(lattice).reference, one.reference);
  ASSERT_GT(one.sets.at("left").size(), 10u);
  for (const Index i : one.sets.at("left")) {
    EXPECT_EQ(one.position(i), still.position(i));
    EXPECT_EQ(one.volume[i], still.volume[i]);
  }
}

// Of a line the cells are intervals: neighbours share their ends.
TEST(PerturbedCells, OfALineAreIntervals) {
  Lattice lattice;
  lattice.dimension = 1;
  lattice.spacing = 0.1;
  lattice.shapes = {{ShapeStep::Action::add, Box{{0, 0, 0}, {2, 0, 0}}}};
  lattice.cell_perturbation = 0.2;
  const Points points = make_points(lattice);
  double end = 0.0;
  for (Index i = 0; i < points.count(); ++i) {
    EXPECT_NEAR(points.reference[i] - 0.5 * points.volume[i], end, 1e-15 * 20);
    end += points.volume[i];
    EXPECT_GE(points.volume[i], 0.06);
  }
  EXPECT_NEAR(end, 2.0, 1e-14);
}

TEST(PerturbedCells, RefuseWhatIsNoneOfTheirs) {
  const auto refusal = [](auto change) {
    Lattice lattice = with_perturbed_cells(0.1, 0.0);
    change(lattice);
    try {
      static_cast<void>(make_points(lattice));
    } catch (const InputError& error) {
      return error.key();
    }
    return std::string();
  };
  EXPECT_EQ(refusal([](Lattice& of) { of.cell_perturbation = 0.25; }), "cell_perturbation");
  EXPECT_EQ(refusal([](Lattice& of) { of.cell_perturbation = -0.1; }), "cell_perturbation");
  EXPECT_EQ(refusal([](Lattice& of) { of.perturbation = 0.1; }), "cell_perturbation");
  EXPECT_EQ(refusal([](Lattice& of) { of.volumes = CellVolumes::fractional; }),
            "cell_perturbation");
  EXPECT_EQ(refusal([](Lattice&) {}), "");
}

}  // namespace
}  // namespace peristat
