// Distance of a point from a closed segment or triangle: least over all places of it, and
// derivatives.
#include "src/geometry/facet_approach.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

using tests::Random;

struct Sight {
  int dimension, corners;
};

/// A point and the corners of a part, at random; the first place is the point's.
FacetArms arms_of(const std::vector<double>& places, int dimension, int corners) {
  FacetArms arms;
  arms.corners = corners;
  const auto d = std::size_t(dimension);
  for (std::size_t k = 0; k < std::size_t(corners); ++k) {
    for (std::size_t c = 0; c < d; ++c) {
      arms.reference[k][c] = 0.25 * places[(k + 1) * d + c];
      arms.moved[k][c] = 0.75 * places[(k + 1) * d + c] - places[c];
    }
  }
  return arms;
}

class FacetApproaches : public ::testing::TestWithParam<Sight> {};

TEST_P(FacetApproaches, AreTheLeastDistance) {
  const auto [dimension, corners] = GetParam();
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const FacetArms arms =
        arms_of(Random(seed).vector(std::size_t(dimension * (corners + 1))), dimension, corners);
    double least = 1e9;
    constexpr int steps = 60;
    for (int a = 0; a <= (corners > 1 ? steps : 0); ++a) {
      for (int b = 0; b <= (corners > 2 ? steps - a : 0); ++b) {
        const double v = double(a) / steps, w = double(b) / steps;
        Coordinates place = scaled(1.0 - v - w, arms.present(0));
        if (corners > 1) place = plus(place, scaled(v, arms.present(1)));
        if (corners > 2) place = plus(place, scaled(w, arms.present(2)));
        least = std::min(least, length(place));
      }
    }
    const FacetApproach found = approach(arms, 0.7);
    EXPECT_LE(found.distance, least + 1e-14);
    EXPECT_GE(found.distance, least - 0.03);
    EXPECT_NEAR(found.distance, facet_distance(arms), 1e-14);
    EXPECT_NEAR(found.overlap, 0.7 - found.distance, 1e-14);
  }
}

TEST_P(FacetApproaches, HaveTheirDerivatives) {
  const auto [dimension, corners] = GetParam();
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::vector<double> at = Random(seed).vector(std::size_t(dimension * (corners + 1)));
    const std::vector<double> v = Random(seed + 99).vector(at.size());
    const auto first_at = [&](double t) {
      std::vector<double> there = at;
      for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
      const FacetArms arms = arms_of(there, dimension, corners);
      const auto found = derivatives(arms, approach(arms, 0.7), dimension);
      return std::vector<double>(found.first.begin(), found.first.begin() + long(at.size()));
    };
    const FacetArms arms = arms_of(at, dimension, corners);
    const auto found = derivatives(arms, approach(arms, 0.7), dimension);
    double slope = 0.0;
    std::vector<double> bend(at.size(), 0.0);
    for (std::size_t r = 0; r < at.size(); ++r) {
      slope += found.first[r] * v[r];
      for (std::size_t c = 0; c < at.size(); ++c) bend[r] += found.second[r][c] * v[c];
    }
    const auto distance_at = [&](double t) {
      std::vector<double> there = at;
      for (std::size_t k = 0; k < at.size(); ++k) there[k] += t * v[k];
      return facet_distance(arms_of(there, dimension, corners));
    };
    constexpr double step = 1e-6;
    EXPECT_NEAR((distance_at(step) - distance_at(-step)) / (2.0 * step), slope, 1e-8) << seed;
    EXPECT_TRUE(tests::is_derivative(first_at, bend, 1e-4)) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Parts, FacetApproaches,
                         ::testing::Values(Sight{2, 1}, Sight{2, 2}, Sight{3, 1}, Sight{3, 2},
                                           Sight{3, 3}),
                         [](const auto& param) {
                           return std::to_string(param.param.corners) + "In" +
                                  std::to_string(param.param.dimension) + "D";
                         });

}  // namespace
}  // namespace peristat
