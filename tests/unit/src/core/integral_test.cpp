#include "src/core/integral.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace peristat {
namespace {

TEST(Integral, IsThatOfClosedForms) {
  EXPECT_NEAR(integral([](double x) { return std::exp(x); }, 0.0, 1.0), std::expm1(1.0), 4e-15);
  EXPECT_NEAR(integral([](double x) { return std::exp(x); }, 1.0, 0.0), -std::expm1(1.0), 4e-15);
  EXPECT_NEAR(integral([](double x) { return 1.0 / (1.0 + 1e4 * x * x); }, -1.0, 1.0),
              0.02 * std::atan(100.0), 1e-15);
  EXPECT_EQ(integral([](double) { return 0.0; }, 0.0, 1.0), 0.0);
}

TEST(Integral, OfAnOddFunctionIsZeroToTheRoundOffOfItsParts) {
  EXPECT_NEAR(integral([](double x) { return std::sin(40.0 * x); }, -1.0, 1.0), 0.0, 1e-14);
}

/// Sigmoids as steep as laws of damage are, a kink and a jump: over ranges as short as theirs it
/// takes as many values as over a long one.
TEST(Integral, TakesFewValuesHoweverShortTheRange) {
  for (const double length : {1.0, 4e-3, 1e-9}) {
    int values = 0;
    const auto counted = [&](const auto& of) {
      values = 0;
      const auto of_share = [&](double x) {
        ++values;
        return of(x / length);
      };
      return integral(of_share, 0.0, length) / length;
    };
    const auto sigmoid = [](double x) { return 1.0 / (1.0 + std::exp(24.0 * (x - 0.5))); };
    EXPECT_NEAR(counted(sigmoid), 0.5, 1e-14);
    EXPECT_LT(values, 1000);
    EXPECT_NEAR(counted([](double x) { return std::abs(x - 0.3); }), 0.29, 1e-14);
    EXPECT_LT(values, 3000);
    EXPECT_NEAR(counted([](double x) { return x < 0.3 ? 1.0 : 0.0; }), 0.3, 1e-11);
    EXPECT_LT(values, 3000);
  }
}

}  // namespace
}  // namespace peristat
