// The bar of [ADAPT] 3.1 against u(x) = F x / (A E).
#include <cmath>

#include <gtest/gtest.h>

#include "src/core/number_text.hpp"
#include "tests/verification/solved_case.hpp"

namespace peristat {
namespace {

constexpr double force = 200.0, modulus = 200e9, area = 1e-6;

/// Relative L2 error of the displacement over the points of the bar proper ([ADAPT] 3.1).
double relative_error(int points, const std::string& correction) {
  const SolvedCase bar =
      solve_case("bar/tension.toml", {{"lattice.spacing", number_text(1.0 / points)},
                                      {"quadrature.volume_correction", '"' + correction + '"'}});
  EXPECT_EQ(bar.result.outcome, Outcome::converged);
  double difference = 0.0, size = 0.0;
  int counted = 0;
  for (Index i = 0; i < bar.body->points.count(); ++i) {
    const double x = bar.body->points.reference[i];
    if (x < 0.0) continue;  // the layer that holds the bar
    const double exact = force * x / (area * modulus);
    difference += std::pow(bar.result.state.displacement[i] - exact, 2);
    size += exact * exact;
    ++counted;
  }
  EXPECT_EQ(counted, points);
  return std::sqrt(difference / size);
}

TEST(Bar, ConvergesAtRateOneWithTheVolumeCorrection) {
  const double coarse = relative_error(50, "linear");
  const double middle = relative_error(100, "linear");
  const double fine = relative_error(200, "linear");
  EXPECT_GT(fine, 0.0);
  // Errors C h + O(h^2): the observed rate differs from 1 by a term of the order of h.
  EXPECT_NEAR(std::log2(coarse / middle), 1.0, 0.05);
  EXPECT_NEAR(std::log2(middle / fine), 1.0, 0.05);
}

TEST(Bar, StallsWithoutTheVolumeCorrection) {
  // At horizon 3 the lattice sum 2 (1 + 2 + 3) / 3^2 of a bond's stiffness is 4/3 of the
  // continuum's: the strain is 3/4 of the exact one at any spacing.
  EXPECT_NEAR(relative_error(100, "none"), 0.25, 0.02);
  EXPECT_NEAR(relative_error(400, "none"), 0.25, 0.005);
}

TEST(Bar, ReactionBalancesTheForce) {
  const SolvedCase bar = solve_case("bar/tension.toml");
  ASSERT_EQ(bar.steps.size(), 1u);
  // A linear problem: one direct solve, which leaves round-off only.
  EXPECT_NEAR(bar.steps.back().reactions.at("left")[0], -force, 1e-9 * force);
}

}  // namespace
}  // namespace peristat
