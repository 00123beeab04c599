#include "src/neighbourhood/ghost_sites.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "src/geometry/lattice_sites.hpp"

namespace peristat {
namespace {

constexpr auto add = ShapeStep::Action::add;
constexpr auto subtract = ShapeStep::Action::subtract;

Lattice plate(double width = 1.2, double height = 0.8) {
  Lattice lattice;
  lattice.spacing = 0.1;
  lattice.shapes = {{add, Box{{0, 0, 0}, {width, height, 0}}}};
  return lattice;
}

Lattice plate_with_hole() {
  Lattice lattice = plate();
  lattice.shapes.push_back({subtract, Disk{{0.6, 0.4, 0}, 0.25}});
  return lattice;
}

Cell cell_of(const LatticeFrame& frame, const Coordinates& place) {
  const Coordinates at = frame.spacings_to(place);
  Cell cell{};
  for (int c = 0; c < frame.dimension(); ++c)
    cell[std::size_t(c)] = std::llround(at[std::size_t(c)]);
  return cell;
}

Coordinates position(const GhostSites& ghosts, int dimension, Index ghost) {
  Coordinates at{};
  for (int c = 0; c < dimension; ++c)
    at[std::size_t(c)] = ghosts.reference[std::size_t(ghost * dimension + c)];
  return at;
}

double distance(const Coordinates& a, const Coordinates& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Every place in a large box that holds no point and has one within the radius, one by one.
std::map<Cell, Coordinates> expected(const Lattice& lattice, const Points& points, double radius) {
  const LatticeFrame frame = frame_of(lattice);
  std::set<Cell> taken;
  Cell low{}, high{};
  for (Index k = 0; k < points.count(); ++k) {
    const Cell cell = cell_of(frame, points.position(k));
    taken.insert(cell);
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], cell[c]);
      high[c] = std::max(high[c], cell[c]);
    }
  }
  for (int c = 0; c < lattice.dimension; ++c) {
    const auto beyond = std::int64_t(radius / lattice.spacing.along(c)) + 2;
    low[std::size_t(c)] -= beyond;
    high[std::size_t(c)] += beyond;
  }
  std::map<Cell, Coordinates> result;
  for (auto x = low[0]; x <= high[0]; ++x) {
    for (auto y = low[1]; y <= high[1]; ++y) {
      for (auto z = low[2]; z <= high[2]; ++z) {
        const Cell cell{x, y, z};
        if (taken.count(cell) > 0) continue;
        const Coordinates place = frame.position(cell);
        for (Index k = 0; k < points.own(); ++k) {
          if (distance(place, points.position(k)) > radius * (1.0 + 1e-8)) continue;
          result[cell] = place;
          break;
        }
      }
    }
  }
  return result;
}

void expect_all(const Lattice& lattice, double radius) {
  const Points points = make_points(lattice);
  const GhostSites ghosts = ghost_sites(lattice, points, radius);
  const auto all = expected(lattice, points, radius);
  ASSERT_EQ(std::size_t(ghosts.count()), all.size());
  ASSERT_EQ(ghosts.reference.size(), all.size() * std::size_t(lattice.dimension));
  Index ghost = 0;
  for (const auto& [cell, place] : all) {
    EXPECT_EQ(ghosts.cell[std::size_t(ghost)], cell);
    EXPECT_EQ(position(ghosts, lattice.dimension, ghost), place);
    ++ghost;
  }
}

TEST(GhostSites, OfASquareAreCounted) {
  // One point has the 28 neighbours within 3 spacings, 36 within 3.5.
  Lattice lattice = plate(0.1, 0.1);
  EXPECT_EQ(ghost_sites(lattice, make_points(lattice), 0.3).count(), 28);
  EXPECT_EQ(ghost_sites(lattice, make_points(lattice), 0.35).count(), 36);
  // Around n x m points: 2 (n + m) columns of 3, and at each corner (1,1), (1,2), (2,1), (2,2).
  lattice = plate();
  EXPECT_EQ(ghost_sites(lattice, make_points(lattice), 0.3).count(), 2 * (12 + 8) * 3 + 4 * 4);
}

TEST(GhostSites, AreThePlacesAroundThePoints) {
  expect_all(plate(), 0.35);
  expect_all(plate_with_hole(), 0.3);
  Lattice nodes = plate_with_hole();
  nodes.origin = LatticeOrigin::nodes;
  expect_all(nodes, 0.4);
}

TEST(GhostSites, FillAHole) {
  const Lattice whole = plate(), holed = plate_with_hole();
  const Points points = make_points(whole);
  const GhostSites of_whole = ghost_sites(whole, points, 0.35);
  const GhostSites of_holed = ghost_sites(holed, make_points(holed), 0.35);
  // All places of the small hole are within reach of its rim.
  EXPECT_EQ(of_holed.count() - of_whole.count(), points.count() - make_points(holed).count());
  std::set<Coordinates> places;
  for (Index k = 0; k < points.count(); ++k) places.insert(points.position(k));
  for (Index k = 0; k < of_holed.count(); ++k) {
    const Coordinates at = position(of_holed, 2, k);
    const bool is_in_hole = distance(at, {0.6, 0.4, 0.0}) <= 0.25 * (1.0 + 1e-9);
    EXPECT_EQ(is_in_hole, places.count(at) == 1);
  }
}

TEST(GhostSites, OfALargeHoleAreItsRim) {
  Lattice lattice = plate(4.0, 4.0);
  lattice.shapes.push_back({subtract, Disk{{2.0, 2.0, 0}, 1.5}});
  expect_all(lattice, 0.35);
}

TEST(GhostSites, OfATurnedLatticeAndUnequalSpacings) {
  Lattice lattice = plate_with_hole();
  lattice.angle = 27.0;
  expect_all(lattice, 0.35);
  lattice = plate_with_hole();
  lattice.spacing = Spacing({0.1, 0.08, 0.0}, 2);
  expect_all(lattice, 0.31);
  lattice.angle = -63.0;
  expect_all(lattice, 0.31);
}

TEST(GhostSites, AreOutsideLayers) {
  Lattice lattice = plate_with_hole();
  lattice.layers = {{"left", {0, -1}, 6, ""}, {"top", {1, 1}, 2, "x > 0.55"}};
  expect_all(lattice, 0.35);
}

TEST(GhostSites, OfOneAndThreeDimensions) {
  Lattice lattice;
  lattice.dimension = 1;
  lattice.spacing = 0.1;
  lattice.shapes = {{add, Box{{0, 0, 0}, {1.0, 0, 0}}}, {subtract, Box{{0.4, 0, 0}, {0.5, 0, 0}}}};
  EXPECT_EQ(ghost_sites(lattice, make_points(lattice), 0.3).count(), 7);
  expect_all(lattice, 0.3);

  lattice.dimension = 3;
  lattice.shapes = {{add, Box{{0, 0, 0}, {0.1, 0.1, 0.1}}}};
  EXPECT_EQ(ghost_sites(lattice, make_points(lattice), 0.3).count(), 122);
  lattice.shapes = {{add, Box{{0, 0, 0}, {1.0, 0.8, 0.6}}},
                    {subtract, Sphere{{0.5, 0.4, 0.3}, 0.2}},
                    {subtract, Box{{0.7, 0.5, 0.4}, {2.0, 2.0, 2.0}}}};
  expect_all(lattice, 0.3);
  lattice.spacing = Spacing({0.1, 0.08, 0.12}, 3);
  lattice.angle = 30.0;
  expect_all(lattice, 0.25);
}

TEST(GhostSites, OfACutLattice) {
  Lattice lattice = plate_with_hole();
  lattice.volumes = CellVolumes::fractional;
  lattice.layers = {{"left", {0, -1}, 3, ""}};
  lattice.shapes[0].shape = Box{{0.03, 0, 0}, {1.17, 0.8, 0}};
  expect_all(lattice, 0.35);
}

TEST(GhostSites, OfAPerturbedLatticeAreWithinTheRadiusOfPoints) {
  for (const int dimension : {2, 3}) {
    Lattice lattice = plate_with_hole();
    lattice.dimension = dimension;
    if (dimension == 3) {
      lattice.shapes = {{add, Box{{0, 0, 0}, {0.8, 0.6, 0.5}}},
                        {subtract, Sphere{{0.4, 0.3, 0.3}, 0.2}}};
    }
    lattice.perturbation = 0.3;
    lattice.angle = 20.0;
    lattice.seed = 5;
    const double radius = 0.3;
    const Points points = make_points(lattice);
    const GhostSites ghosts = ghost_sites(lattice, points, radius);
    const LatticeFrame frame = frame_of(lattice);
    std::set<Cell> seen;
    double farthest = 0.0;
    for (Index k = 0; k < ghosts.count(); ++k) {
      const Coordinates at = position(ghosts, dimension, k);
      EXPECT_EQ(cell_of(frame, at), ghosts.cell[std::size_t(k)]);
      seen.insert(ghosts.cell[std::size_t(k)]);
      double nearest = 1e9;
      for (Index p = 0; p < points.count(); ++p)
        nearest = std::min(nearest, distance(at, points.position(p)));
      EXPECT_LE(nearest, radius * (1.0 + 1e-8));
      const Coordinates steps = frame.spacings_to(at);
      for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
        const double off = std::abs(steps[c] - double(ghosts.cell[std::size_t(k)][c]));
        EXPECT_LE(off, 0.3);
        farthest = std::max(farthest, off);
      }
    }
    EXPECT_GT(farthest, 0.29);
    EXPECT_EQ(Index(seen.size()), ghosts.count());
    // None is missing: with a larger radius come none that were within the smaller one.
    const GhostSites more = ghost_sites(lattice, points, 1.5 * radius);
    Index within = 0;
    for (Index k = 0; k < more.count(); ++k) {
      const Coordinates at = position(more, dimension, k);
      bool is_near = false;
      for (Index p = 0; p < points.count() && !is_near; ++p)
        is_near = distance(at, points.position(p)) <= radius * (1.0 + 1e-8);
      within += is_near;
    }
    EXPECT_EQ(within, ghosts.count());
  }
}

TEST(GhostSites, OfAPerturbedLatticeFollowFromSeedAndPlace) {
  Lattice lattice = plate_with_hole();
  lattice.perturbation = 0.2;
  const auto shifted = [](const Lattice& of) {
    const GhostSites ghosts = ghost_sites(of, make_points(of), 0.35);
    std::map<Cell, Coordinates> result;
    for (Index k = 0; k < ghosts.count(); ++k)
      result[ghosts.cell[std::size_t(k)]] = position(ghosts, 2, k);
    return result;
  };
  const auto some = shifted(lattice);
  // Another hole, and a body that ends elsewhere: common places have the same ghosts.
  Lattice other = lattice;
  other.shapes[1].shape = Disk{{0.7, 0.4, 0}, 0.25};
  other.shapes.push_back({subtract, Box{{-1, -1, 0}, {0.2, 2, 0}}});
  int common = 0;
  for (const auto& [cell, place] : shifted(other)) {
    const auto same = some.find(cell);
    if (same == some.end()) continue;
    EXPECT_EQ(same->second, place);
    ++common;
  }
  EXPECT_GT(common, 100);
  lattice.seed = 2;
  for (const auto& [cell, place] : shifted(lattice))
    EXPECT_TRUE(some.count(cell) == 0 || some.at(cell) != place);
}

TEST(GhostSites, LeaveThePlacesOfImagesToThem) {
  Lattice lattice = plate();
  Points points = make_points(lattice);
  const Index without = ghost_sites(lattice, points, 0.3).count();
  const Index own = points.count();
  add_images(points, {{0, 0.0}}, {}, 0.3);
  ASSERT_GT(points.count(), own);
  EXPECT_EQ(ghost_sites(lattice, points, 0.3).count(), without - (points.count() - own));
}

TEST(GhostSites, RefuseARadiusThatCannotBeUsed) {
  const Lattice lattice = plate();
  const Points points = make_points(lattice);
  for (const double radius : {0.0, -1.0, std::nan(""), 1e9})
    EXPECT_THROW((void)ghost_sites(lattice, points, radius), InputError);
}

}  // namespace
}  // namespace peristat
