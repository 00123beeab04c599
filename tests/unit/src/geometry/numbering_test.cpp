#include "src/geometry/numbering.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace peristat {
namespace {

/// Lattice places i * spacing per direction, in a random order.
std::vector<double> shuffled_lattice(const std::vector<int>& counts, double spacing, int seed) {
  std::vector<std::vector<double>> places{{}};
  for (const int count : counts) {
    std::vector<std::vector<double>> longer;
    for (const auto& place : places) {
      for (int i = 0; i < count; ++i) {
        longer.push_back(place);
        longer.back().push_back(-0.3 + i * spacing);
      }
    }
    places = longer;
  }
  std::shuffle(places.begin(), places.end(), std::mt19937(seed));
  std::vector<double> reference;
  for (const auto& place : places) reference.insert(reference.end(), place.begin(), place.end());
  return reference;
}

std::vector<double> ordered(int dimension, double spacing, const std::vector<double>& reference) {
  std::vector<double> result;
  for (const Index old : locality_order(dimension, spacing, reference)) {
    const auto first = reference.begin() + old * dimension;
    result.insert(result.end(), first, first + dimension);
  }
  return result;
}

TEST(LocalityOrder, RunsFastestAlongTheShortestDirection) {
  // 3 x 2 points: x is the longer direction and slowest.
  const std::vector<double> reference{0, 0, 1, 0, 2, 0, 0, 1, 1, 1, 2, 1};
  EXPECT_EQ(locality_order(2, 1.0, reference), (std::vector<Index>{0, 3, 1, 4, 2, 5}));
  // 2 x 3 points: y is the longer direction.
  const std::vector<double> turned{0, 0, 0, 1, 0, 2, 1, 0, 1, 1, 1, 2};
  EXPECT_EQ(locality_order(2, 1.0, turned), (std::vector<Index>{0, 3, 1, 4, 2, 5}));
}

TEST(LocalityOrder, DoesNotDependOnTheOrderFound) {
  const double spacing = 0.1;
  const auto first = ordered(3, spacing, shuffled_lattice({4, 9, 6}, spacing, 1));
  const auto second = ordered(3, spacing, shuffled_lattice({4, 9, 6}, spacing, 2));
  ASSERT_EQ(first.size(), std::size_t{4 * 9 * 6 * 3});
  EXPECT_EQ(first, second);
}

TEST(LocalityOrder, KeepsNeighboursWithinACrossSection) {
  const double spacing = 0.1;
  const auto reference = ordered(3, spacing, shuffled_lattice({4, 20, 5}, spacing, 3));
  const int count = static_cast<int>(reference.size()) / 3;
  int widest = 0;
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      double square = 0.0;
      for (int c = 0; c < 3; ++c) {
        const double difference = reference[3 * a + c] - reference[3 * b + c];
        square += difference * difference;
      }
      if (square < 1.1 * spacing * spacing) widest = std::max(widest, b - a);
    }
  }
  EXPECT_EQ(widest, 4 * 5);  // the next cross section holds the farthest nearest neighbour
}

TEST(LocalityOrder, IsAPermutationOfAnyCloud) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  std::vector<double> reference(2 * 500);
  for (double& coordinate : reference) coordinate = normal(generator);
  reference[0] = 1e200;  // a straggler must not overflow the cells
  auto order = locality_order(2, 1e-150, reference);
  std::sort(order.begin(), order.end());
  std::vector<Index> all(500);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(order, all);
}

TEST(Renumbered, CarriesPlacesVolumesAndSets) {
  Points points;
  points.dimension = 2;
  points.spacing = 1.0;
  points.reference = {0, 10, 1, 11, 2, 12};
  points.volume = {5, 6, 7};
  points.sets = {{"ends", {0, 2}}, {"none", {}}};
  const Points result = renumbered(points, {2, 0, 1});
  EXPECT_EQ(result.dimension, 2);
  EXPECT_EQ(result.spacing, 1.0);
  EXPECT_EQ(result.reference, (std::vector<double>{2, 12, 0, 10, 1, 11}));
  EXPECT_EQ(result.volume, (std::vector<double>{7, 5, 6}));
  EXPECT_EQ(result.sets.at("ends"), (std::vector<Index>{0, 1}));
  EXPECT_EQ(result.sets.count("none"), 1u);
}

}  // namespace
}  // namespace peristat
