#include "src/neighbourhood/search.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

Points points_at(int dimension, std::vector<double> reference) {
  Points points;
  points.dimension = dimension;
  points.volume.assign(reference.size() / std::size_t(dimension), 1.0);
  points.reference = std::move(reference);
  return points;
}

/// Points in the cube from -1 to 1.
Points cloud(int dimension, int count, std::uint64_t seed) {
  return points_at(dimension, tests::Random(seed).vector(std::size_t(count) * dimension));
}

/// Compares with all pairs. Ties are left to the tests that make them: no pair may come closer to
/// the radius than `margin`, relatively.
void expect_all_pairs(const Points& points, const Bonds& bonds, double radius,
                      double margin = 1e-12) {
  ASSERT_EQ(bonds.offset.size(), points.volume.size() + 1);
  ASSERT_EQ(bonds.offset.front(), 0);
  ASSERT_EQ(bonds.offset.back(), bonds.count());
  ASSERT_EQ(bonds.kind.size(), std::size_t(bonds.count()));
  for (Index i = 0; i < points.count(); ++i) {
    std::vector<Index> partners;
    for (Index j = i + 1; j < points.count(); ++j) {
      const double distance = tests::reference_distance(points, i, j);
      ASSERT_GT(std::abs(distance / (radius * (1.0 + 1e-8)) - 1.0), margin);
      if (distance <= radius * (1.0 + 1e-8)) partners.push_back(j);
    }
    const std::vector<Index> found(bonds.of(i).begin(), bonds.of(i).end());
    ASSERT_EQ(found, partners) << "point " << i;
  }
  tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
    const double distance = tests::reference_distance(points, i, j);
    EXPECT_NEAR(bonds.length(bond) / distance, 1.0, 8 * std::numeric_limits<double>::epsilon());
  });
}

TEST(SearchBonds, FindsWhatAllPairsOfARandomCloudGive) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const Points points = cloud(dimension, 400, 3);
    Offset least = std::numeric_limits<Offset>::max(), most = 0;
    for (double radius : {0.01, 0.11, 0.37, 1.3, 5.0}) {
      SCOPED_TRACE(::testing::Message() << dimension << "D, radius " << radius);
      const Bonds bonds = search_bonds(points, radius, 2);
      expect_all_pairs(points, bonds, radius);
      least = std::min(least, bonds.count());
      most = std::max(most, bonds.count());
    }
    EXPECT_LT(least, 2000);
    EXPECT_EQ(most, 400 * 399 / 2);
  }
}

TEST(SearchBonds, FindsWhatAllPairsOfAThinBodyGive) {
  Points points = cloud(3, 300, 4);
  for (std::size_t k = 0; k < points.reference.size(); k += 3) {
    points.reference[k] *= 20.0;
    points.reference[k + 2] = 1e-17 * double(k % 7);  // in a plane, up to round-off
  }
  const Bonds bonds = search_bonds(points, 0.9, 1);
  expect_all_pairs(points, bonds, 0.9);
  EXPECT_GT(bonds.count(), 100);
}

TEST(SearchBonds, FindsPairsWithinTheLargerOfTheirRadii) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const Points points = cloud(dimension, 400, 8);
    std::vector<double> radii = tests::Random(9).vector(400);
    for (double& radius : radii) radius = 0.3 * std::pow(300.0, radius - 0.5);  // 450 to 1
    const Bonds bonds = search_bonds(points, radii, 2);
    Offset expected = 0;
    for (Index i = 0; i < points.count(); ++i) {
      std::vector<Index> partners;
      for (Index j = i + 1; j < points.count(); ++j) {
        const double radius = std::max(radii[std::size_t(i)], radii[std::size_t(j)]);
        if (tests::reference_distance(points, i, j) <= radius) partners.push_back(j);
      }
      const std::vector<Index> found(bonds.of(i).begin(), bonds.of(i).end());
      ASSERT_EQ(found, partners) << dimension << "D, point " << i;
      expected += Offset(partners.size());
    }
    EXPECT_EQ(bonds.count(), expected);
    EXPECT_GT(expected, 400);
    EXPECT_LT(expected, 40000);
    const Bonds one_by_one = search_bonds(points, radii, 1);
    EXPECT_EQ(tests::kinds(one_by_one), tests::kinds(bonds));
  }
}

TEST(SearchBonds, WithEqualRadiiFindsWhatOneRadiusFinds) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const Points points = cloud(dimension, 300, 10);
    const Bonds one = search_bonds(points, 0.4, 1);
    const Bonds each = search_bonds(points, std::vector<double>(300, 0.4), 1);
    ASSERT_GT(one.count(), 100);
    EXPECT_EQ(tests::upper_points(each), tests::upper_points(one));
    EXPECT_EQ(tests::kinds(each), tests::kinds(one));
  }
}

TEST(SearchBonds, FindsNeighboursAtExactlyTheHorizonWhateverTheRoundOff) {
  // Inner points of a lattice whose horizon is m spacings: 2m in 1D; the lattice points of a disk
  // and a ball of radius 2 and 3 without the centre (Gauss circle problem: 13, 29; 33, 123).
  const int expected[3][2] = {{4, 6}, {12, 28}, {32, 122}};
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (int ratio : {2, 3}) {
      for (double spacing : {0.1, 1.0 / 3.0, 0.7e-3, 1e5 / 7.0}) {
        tests::BoxSetting box;
        box.dimension = dimension;
        box.extent = {8, 7, 7};
        box.spacing = spacing;
        const Points points = tests::box_points(box);
        const Bonds bonds = search_bonds(points, ratio * spacing, 2);
        std::vector<int> degree(points.volume.size(), 0);
        tests::for_each_bond(bonds, [&](Index i, Index j, Offset) {
          ++degree[i];
          ++degree[j];
        });
        int inner = 0;
        for (Index i = 0; i < points.count(); ++i) {
          if (!tests::is_inside(points, i, box, (ratio + 0.4) * spacing)) continue;
          ++inner;
          EXPECT_EQ(degree[i], expected[dimension - 1][ratio - 2])
              << dimension << "D, ratio " << ratio << ", spacing " << spacing;
        }
        EXPECT_GT(inner, 0);
      }
    }
  }
}

TEST(SearchBonds, GivesTheSameForAnyNumberOfThreads) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const Points points = cloud(dimension, 300, 5);
    const Bonds one = search_bonds(points, 0.3, 1);
    ASSERT_GT(one.count(), 100);
    for (int threads : {2, 3, 7}) {
      const Bonds several = search_bonds(points, 0.3, threads);
      EXPECT_EQ(several.offset, one.offset);
      EXPECT_EQ(tests::upper_points(several), tests::upper_points(one));
      EXPECT_EQ(tests::kinds(several), tests::kinds(one));
    }
  }
}

TEST(SearchBonds, TakesCloudsWithFarOutliers) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    Points points = cloud(dimension, 300, 6);
    const auto add = [&](double at) {
      for (int c = 0; c < dimension; ++c) points.reference.push_back(c % 2 ? -at : at);
      points.volume.push_back(1.0);
    };
    for (double at : {1e3, 1e3 + 0.01, -1e7, 1e9}) add(at);
    const Bonds bonds = search_bonds(points, 0.25, 2);
    expect_all_pairs(points, bonds, 0.25);
    EXPECT_GT(bonds.count(), 300);
    EXPECT_EQ(bonds.of(300)[0], 301);
  }
}

TEST(SearchBonds, TakesASinglePointAndThreadsWithoutWork) {
  const Bonds bonds = search_bonds(points_at(2, {0.5, -3.0}), 1.0, 4);
  EXPECT_EQ(bonds.points(), 1);
  EXPECT_EQ(bonds.count(), 0);
  const Bonds pair = search_bonds(points_at(3, {0, 0, 0, 0, 0, 1}), 1.0, 4);
  EXPECT_EQ(tests::upper_points(pair), std::vector<Index>{1});
}

}  // namespace
}  // namespace peristat
