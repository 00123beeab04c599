#include "src/potentials/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

constexpr ContactLaw law{0.02};
const std::vector<double> depths{1e-4, 0.003, 0.015, 0.03, 0.4, 0.9, 0.99};

TEST(ContactLaw, ValueAndSlopeAreOneFunction) {
  for (const double x : depths) {
    const auto value = [&](double t) { return std::vector{law(x + t).value}; };
    const auto first = [&](double t) { return std::vector{law(x + t).first}; };
    const double step = 1e-3 * std::min(x, 1.0 - x);
    EXPECT_TRUE(tests::is_derivative(value, {law(x).first}, step)) << x;
    EXPECT_TRUE(tests::is_derivative(first, {law(x).second}, step)) << x;
  }
}

TEST(ContactLaw, HasNoForceBeforeItTouches) {
  for (const double x : {-1.0, -1e-12, 0.0}) {
    EXPECT_EQ(law(x).value, 0.0);
    EXPECT_EQ(law(x).first, 0.0);
    EXPECT_EQ(law(x).second, 0.0);
  }
}

TEST(ContactLaw, GoesOnSmoothlyWhereItsPartsMeet) {
  for (const double x : {0.02, 1.0}) {
    const auto below = law(x * (1.0 - 1e-12)), above = law(x * (1.0 + 1e-12));
    EXPECT_NEAR(below.value, above.value, 1e-8 * above.value);
    EXPECT_NEAR(below.first, above.first, 1e-8 * above.first);
    EXPECT_NEAR(below.second, above.second, 1e-8 * above.second);
  }
}

/// Small depths, where the closed forms cancel.
TEST(ContactLaw, IsExactAtSmallDepths) {
  for (const double x : {1e-6, 1e-5, 1e-4}) {
    // b = x^3 / (6 x0) + x^5 / (20 x0^2) + ...
    const double expected = x * x * x / (6.0 * 0.02) + std::pow(x, 5) / (20.0 * 0.02 * 0.02);
    EXPECT_NEAR(law(x).value, expected, 1e-10 * expected);
  }
}

TEST(ContactLaw, IsALinearSpringBeyondItsOnset) {
  const ContactLaw sharp{1e-6};
  EXPECT_NEAR(sharp(0.01).first, 0.01 / 0.99, 1e-6);
  EXPECT_NEAR(sharp(1e-3).second, 1.0, 3e-3);
  EXPECT_EQ(closed_contact(-0.2).first, -0.2);
  EXPECT_EQ(closed_contact(-0.2).second, 1.0);
}

}  // namespace
}  // namespace peristat
