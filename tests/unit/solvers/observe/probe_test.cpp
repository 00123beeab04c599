#include "solvers/observe/probe.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/connectivity/crack.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;

constexpr double spacing = 0.1;

/// 40 x 12 points, and in 3D 3 layers of them, all in a set.
BoxBody plate(int dimension, double horizon_ratio, double perturbation = 0.0) {
  tests::BoxSetting box = tests::small_box(dimension);
  box.extent = {40, 12, dimension == 3 ? 3 : 0};
  box.spacing = spacing;
  box.horizon_ratio = horizon_ratio;
  box.perturbation = perturbation;
  Points points = tests::box_points(box);
  points.sets["all"].resize(points.volume.size());
  std::iota(points.sets["all"].begin(), points.sets["all"].end(), 0);
  return BoxBody(std::move(points), box);
}

/// The same plate as a cell that repeats over a period.
BoxBody periodic_plate(const Period& period) {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {40, 12, 0};
  box.spacing = spacing;
  box.horizon_ratio = 3.015;
  Points cell = tests::box_points(box);
  cell.sets["all"].resize(cell.volume.size());
  std::iota(cell.sets["all"].begin(), cell.sets["all"].end(), 0);
  add_images(cell, {}, {period}, 3.015 * spacing);
  return BoxBody(std::move(cell), box);
}

/// A straight crack at y = 0.6 from x = low to high, through all of z.
Crack crack(int dimension, double low, double high) {
  if (dimension == 2) return CrackSegment{{low, 0.6, 0}, {high, 0.6, 0}};
  return CrackPolygon{{{low, 0.6, -1}, {high, 0.6, -1}, {high, 0.6, 1}, {low, 0.6, 1}}};
}

double length_of(const std::vector<BondEnds>& separated, const Points& points, int axis = 0) {
  ProbeSpecification probe;
  probe.set = "all";
  probe.field = "crack_length";
  probe.axis = axis;
  return probe_values(probe, points, {}, {separated}).at(0);
}

TEST(CrackLength, IsThatOfAStraightCrackWhateverTheHorizon) {
  for (const int dimension : {2, 3}) {
    for (const double horizon_ratio : {1.5, 2.015, 3.015, 4.5}) {
      const BoxBody body = plate(dimension, horizon_ratio);
      // From the edge, inside, and from edge to edge; the body is 4 m long.
      for (const auto& [low, high] : {std::pair(-1.0, 1.23), {0.77, 2.52}, {-1.0, 5.0}}) {
        Bonds bonds = body.model.bonds();
        const CutBonds cut = cut_bonds(bonds, body.points, {crack(dimension, low, high)});
        const double inside = std::min(high, 4.0) - std::max(low, 0.0);
        // A tip lies anywhere between two columns of points: half a spacing each.
        EXPECT_NEAR(length_of(cut.ends, body.points), inside, spacing) << dimension;
        EXPECT_EQ(length_of(cut.ends, body.points, 1), 0.0);  // no bond along x is cut
      }
    }
  }
}

TEST(CrackLength, CountsCutAndBrokenBondsAlike) {
  const BoxBody body = plate(2, 3.015);
  const auto separated_by = [&](double low, double high) {
    Bonds bonds = body.model.bonds();
    return cut_bonds(bonds, body.points, {crack(2, low, high)}).ends;
  };
  std::vector<BondEnds> separated = separated_by(-1.0, 1.0);  // the pre-crack
  const double before = length_of(separated, body.points);
  for (const BondEnds& broken : separated_by(1.0, 2.5)) separated.push_back(broken);  // it grows
  EXPECT_NEAR(length_of(separated, body.points) - before, 1.5, spacing);
  EXPECT_NEAR(length_of(separated, body.points), length_of(separated_by(-1.0, 2.5), body.points),
              1e-14);
  EXPECT_EQ(length_of({}, body.points), 0.0);
}

TEST(CrackLength, IsFoundOnAPerturbedLattice) {
  const BoxBody body = plate(2, 3.015, 0.2);
  Bonds bonds = body.model.bonds();
  const CutBonds cut = cut_bonds(bonds, body.points, {crack(2, -1.0, 2.0)});
  // Bonds up to half a spacing out of the normal count: their middles move by half of that.
  EXPECT_NEAR(length_of(cut.ends, body.points), 2.0, 1.5 * spacing);
}

TEST(CrackAngle, IsThatOfAStraightCrackOnItsWayThroughTheLattice) {
  const BoxBody body = plate(2, 3.015);
  ProbeSpecification probe;
  probe.set = "all";
  probe.field = "crack_angle";
  const auto angle = [&](const Coordinates& from, const Coordinates& to, int axis) {
    Bonds bonds = body.model.bonds();
    const CutBonds cut = cut_bonds(bonds, body.points, {CrackSegment{from, to}});
    probe.axis = axis;
    return probe_values(probe, body.points, {}, {cut.ends}).at(0);
  };
  EXPECT_NEAR(angle({0.5, 0.6, 0}, {3.0, 0.6, 0}, 0), 0.0, 1e-12);
  EXPECT_NEAR(angle({0.5, 0.6, 0}, {3.0, 0.6, 0}, 1), 90.0, 1e-12);
  // Steps of a spacing in 20 of way: a degree or two.
  EXPECT_NEAR(angle({0.5, 0.1, 0}, {2.0, 1.1, 0}, 0), std::atan2(1.0, 1.5) * 180.0 / M_PI, 2.0);
  EXPECT_NEAR(angle({0.5, 1.1, 0}, {2.0, 0.1, 0}, 0), -std::atan2(1.0, 1.5) * 180.0 / M_PI, 2.0);
  EXPECT_NEAR(angle({0.5, 0.1, 0}, {2.0, 1.1, 0}, 1), 90.0 - std::atan2(1.0, 1.5) * 180.0 / M_PI,
              2.0);
  EXPECT_EQ(angle({5.0, 0.1, 0}, {6.0, 0.1, 0}, 0), 0.0);  // there is none
}

TEST(CrackLength, GoesOnOverAPeriod) {
  const BoxBody body = periodic_plate({0, 0.0, 4.0});
  // Over the side, inside, through the whole cell, and farther than that.
  for (const auto& [low, high] :
       {std::pair(-0.52, 0.71), {3.6, 4.9}, {0.77, 2.52}, {0.0, 4.0}, {-1.0, 5.0}}) {
    Bonds bonds = body.model.bonds();
    const CutBonds cut = cut_bonds(bonds, body.points, {crack(2, low, high)});
    EXPECT_NEAR(length_of(cut.ends, body.points), std::min(high - low, 4.0), spacing) << low;
  }
}

TEST(CrackLength, LeavesOtherSetsAlone) {
  BoxBody body = plate(2, 3.015);
  Bonds bonds = body.model.bonds();
  const CutBonds cut = cut_bonds(bonds, body.points, {crack(2, -1.0, 2.0)});
  auto& members = body.points.sets["all"];
  std::erase_if(members, [&](Index i) { return body.points.position(i)[0] > 1.0; });
  EXPECT_NEAR(length_of(cut.ends, body.points), 1.0, spacing);
}

double measured(const std::string& field, const CrackState& crack, const Points& points) {
  ProbeSpecification probe;
  probe.set = "all";
  probe.field = field;
  return probe_values(probe, points, {}, crack).at(0);
}

TEST(CrackMeasure, TellsWhereACrackBeginsAndEnds) {
  const BoxBody body = plate(2, 3.015);
  Bonds bonds = body.model.bonds();
  const CutBonds cut = cut_bonds(bonds, body.points, {crack(2, 0.77, 2.52)});
  EXPECT_NEAR(measured("crack_begin", {cut.ends}, body.points), 0.77, spacing);
  EXPECT_NEAR(measured("crack_end", {cut.ends}, body.points), 2.52, spacing);
  EXPECT_EQ(measured("crack_end", {}, body.points), 0.0);
}

TEST(CrackMeasure, AreaIsThatOfTheFacesBetweenTheCells) {
  for (const int dimension : {2, 3}) {
    for (const double horizon_ratio : {1.5, 3.015}) {
      const BoxBody body = plate(dimension, horizon_ratio);
      Bonds bonds = body.model.bonds();
      const CutBonds cut = cut_bonds(bonds, body.points, {crack(dimension, -1.0, 2.0)});
      const double width = dimension == 3 ? 3 * spacing : 0.5;  // three layers, or the thickness
      EXPECT_NEAR(measured("crack_area", {cut.ends}, body.points), 2.0 * width, 1e-12);
    }
  }
}

TEST(CrackMeasure, AreaIsTheSameOnPerturbedLattices) {
  for (const int dimension : {2, 3}) {
    for (const double perturbation : {0.1, 0.3, 0.49}) {  // no point leaves its row
      const BoxBody body = plate(dimension, 3.015, perturbation);
      Bonds bonds = body.model.bonds();
      const CutBonds cut = cut_bonds(bonds, body.points, {crack(dimension, -1.0, 5.0)});
      const double width = dimension == 3 ? 3 * spacing : 0.5;
      EXPECT_NEAR(measured("crack_area", {cut.ends}, body.points), 4.0 * width, 1e-12);
    }
  }
}

TEST(CrackMeasure, AreaOfASlantingCrackIsThatOfItsProjections) {
  const BoxBody body = plate(2, 3.015);
  Bonds bonds = body.model.bonds();
  const CutBonds cut =
      cut_bonds(bonds, body.points, {CrackSegment{{1.0, 0.23, 0}, {1.7, 0.93, 0}}});
  EXPECT_NEAR(measured("crack_area", {cut.ends}, body.points), (0.7 + 0.7) * 0.5,
              2 * spacing * 0.5);
}

TEST(CrackMeasure, OverAPeriodAFaceCountsOnce) {
  const BoxBody body = periodic_plate({1, 0.0, 1.2});
  Bonds bonds = body.model.bonds();
  const CutBonds cut = cut_bonds(bonds, body.points, {CrackSegment{{-1.0, 0.0, 0}, {2.0, 0.0, 0}}});
  EXPECT_NEAR(measured("crack_area", {cut.ends}, body.points), 2.0 * 0.5, 1e-12);
}

TEST(CrackMeasure, WorkOfFractureIsOfTheAreaThatHasGrown) {
  const BoxBody body = plate(2, 3.015);
  const auto separated_by = [&](double low, double high) {
    Bonds bonds = body.model.bonds();
    return cut_bonds(bonds, body.points, {crack(2, low, high)}).ends;
  };
  std::vector<BondEnds> separated = separated_by(-1.0, 1.0);
  const std::size_t cut = separated.size();
  EXPECT_EQ(measured("work_of_fracture", {separated, cut, 3.0}, body.points), 0.0);
  for (const BondEnds& broken : separated_by(1.0, 2.5)) {
    if (std::ranges::find(separated, broken) == separated.end()) separated.push_back(broken);
  }
  EXPECT_NEAR(measured("work_of_fracture", {separated, cut, 3.0}, body.points), 3.0 / (1.5 * 0.5),
              1e-9);
}

TEST(CrackMeasure, ResistanceIsOfTheAreaGrownSinceItGrewLast) {
  const BoxBody body = plate(2, 3.015);
  const auto separated_by = [&](double low, double high) {
    Bonds bonds = body.model.bonds();
    return cut_bonds(bonds, body.points, {crack(2, low, high)}).ends;
  };
  std::vector<BondEnds> separated = separated_by(-1.0, 1.0);
  const std::size_t cut = separated.size();
  const auto resistance = [&](double dissipated, const CrackGrowth& before) {
    return measured("crack_resistance", {separated, cut, 0.0, dissipated, before}, body.points);
  };
  EXPECT_EQ(resistance(3.0, {}), 0.0);  // a pre-crack is none that grew
  for (const BondEnds& broken : separated_by(1.0, 2.5)) {
    if (std::ranges::find(separated, broken) == separated.end()) separated.push_back(broken);
  }
  EXPECT_NEAR(resistance(3.0, {}), 3.0 / (1.5 * 0.5), 1e-9);
  EXPECT_NEAR(resistance(3.0, {1.0 * 0.5, 2.4}), 0.6 / (0.5 * 0.5), 1e-9);
  const double grown = grown_area(body.points, body.points.sets.at("all"), {separated, cut});
  EXPECT_NEAR(grown, 1.5 * 0.5, 1e-9);
  EXPECT_EQ(resistance(3.1, {grown, 3.0}), 0.0);  // dissipates, but does not grow
  // The order in which the bonds are known is none of its business, to the last bit.
  std::reverse(separated.begin() + std::ptrdiff_t(cut), separated.end());
  EXPECT_EQ(grown_area(body.points, body.points.sets.at("all"), {separated, cut}), grown);
}

}  // namespace
}  // namespace peristat
