#include "src/materials/random_field.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "src/geometry/numbering.hpp"

namespace peristat {
namespace {

Points square(int side, double spacing) {
  Points points;
  points.dimension = 2;
  points.spacing = spacing;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      points.reference.insert(points.reference.end(), {x * spacing, y * spacing});
      points.volume.push_back(spacing * spacing);
    }
  }
  return points;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

double deviation(const std::vector<double>& values) {
  const double middle = mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - middle) * (value - middle);
  return std::sqrt(sum / double(values.size()));
}

/// sqrt(Gamma(1 + 2/m) / Gamma(1 + 1/m)^2 - 1)
double coefficient_of_variation(double m) {
  return std::sqrt(std::tgamma(1.0 + 2.0 / m) / std::pow(std::tgamma(1.0 + 1.0 / m), 2) - 1.0);
}

/// The Gaussian value that a factor comes from: Phi^-1(P(f)), by bisection.
double gaussian_of(double factor, double m) {
  const double below = -std::expm1(-std::pow(factor * std::tgamma(1.0 + 1.0 / m), m));
  double low = -9.0, high = 9.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < below ? low : high) = middle;
  }
  return low;
}

TEST(WeibullField, OfIndependentPointsHasTheMeanAndScatterOfItsDistribution) {
  const Points points = square(200, 1.0);
  for (const double m : {1.0, 3.0, 10.0, 40.0}) {
    const auto values = values_at(points, {m, 0.0, 7}, 1);
    const double expected = coefficient_of_variation(m);
    // Of 40 000 values the mean strays by 1/200 of the deviation, the deviation by some 1/200, and
    // for m = 1 by 1/100: three of these.
    EXPECT_NEAR(mean(values), 1.0, 3.0 / 200.0 * expected) << m;
    EXPECT_NEAR(deviation(values), expected, 3.0 / 100.0 * expected) << m;
    EXPECT_GT(*std::min_element(values.begin(), values.end()), 0.0);
    // The median tells the shape beside mean and scatter.
    auto sorted = values;
    std::nth_element(sorted.begin(), sorted.begin() + 20'000, sorted.end());
    const double median = std::pow(std::log(2.0), 1.0 / m) / std::tgamma(1.0 + 1.0 / m);
    EXPECT_NEAR(sorted[20'000], median, 4.0 / 200.0 * expected) << m;
  }
}

TEST(WeibullField, OfNeighboursIsUncorrelatedWithoutALength) {
  const int side = 200;
  const auto values = values_at(square(side, 1.0), {8.0, 0.0, 3}, 1);
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < values.size(); ++k) {
    sum += (values[k] - 1.0) * (values[k + 1] - 1.0);
  }
  const double correlation = sum / double(values.size()) / std::pow(deviation(values), 2);
  EXPECT_LT(std::abs(correlation), 4.0 / 200.0);  // 1/sqrt of the number of pairs, fourfold
}

TEST(WeibullField, HasTheCorrelationThatItSays) {
  // Means over bodies of 40 lengths, with 16 seeds: some 16 * 40^2/pi independent places.
  constexpr int side = 120, seeds = 16;
  constexpr double length = 3.0, m = 6.0;
  const Points points = square(side, 1.0);
  std::vector<double> covariance(3 * int(length) + 1, 0.0);
  double middle = 0.0, square_sum = 0.0, count = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::vector<double> g = values_at(points, {m, length, std::uint64_t(seed)}, 2);
    middle += mean(g) / seeds;
    square_sum += std::pow(deviation(g), 2) / seeds;
    for (double& value : g) value = gaussian_of(value, m);
    for (std::size_t lag = 0; lag < covariance.size(); ++lag) {
      double sum = 0.0;
      for (int x = 0; x < side; ++x) {
        for (int y = 0; y + int(lag) < side; ++y) sum += g[x * side + y] * g[x * side + y + lag];
      }
      covariance[lag] += sum / (side * double(side - int(lag))) / seeds;
    }
    count += 1.0;
  }
  const double scatter = coefficient_of_variation(m);
  EXPECT_NEAR(middle, 1.0, 0.05 * scatter);  // 1/sqrt(8000) of it, fourfold
  EXPECT_NEAR(std::sqrt(square_sum), scatter, 0.05 * scatter);
  for (std::size_t lag = 0; lag < covariance.size(); ++lag) {
    const double expected = std::exp(-std::pow(double(lag) / length, 2));
    EXPECT_NEAR(covariance[lag], expected, 0.05) << lag;
  }
  EXPECT_NEAR(covariance[std::size_t(length)], std::exp(-1.0), 0.05);
}

TEST(WeibullField, FollowsFromSeedAndPlaceAlone) {
  const Points points = square(30, 0.1);
  std::vector<Index> order(points.volume.size());
  std::iota(order.begin(), order.end(), 0);
  std::reverse(order.begin(), order.end());
  std::swap(order[3], order[700]);
  const Points shuffled = renumbered(points, order);
  for (const double length : {0.0, 0.7}) {
    const WeibullField field{5.0, length, 42};
    const auto one = values_at(points, field, 1), two = values_at(points, field, 2);
    EXPECT_EQ(one, two);
    const auto moved = values_at(shuffled, field, 2);
    for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(moved[k], one[std::size_t(order[k])]);
    EXPECT_NE(one, values_at(points, {5.0, length, 43}, 1));
    Points negative_zero = points;
    for (double& at : negative_zero.reference) at = at == 0.0 ? -0.0 : at;
    EXPECT_EQ(one, values_at(negative_zero, field, 1));
  }
}

}  // namespace
}  // namespace peristat
