#include "src/core/decimal.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace peristat {
namespace {

TEST(ShiftedDecimal, IsTheDoubleNearestToTheDecimal) {
  EXPECT_EQ(shifted_decimal("2.5", -3), 0.0025);
  EXPECT_EQ(shifted_decimal("+2.5e+2", -3), 0.25);
  EXPECT_EQ(shifted_decimal("-7.", 2), -700.0);
  EXPECT_EQ(shifted_decimal(".1", 6), 1e5);
  EXPECT_EQ(shifted_decimal("0", 9), 0.0);
  int rounded_twice = 0;
  for (int k = 1; k < 1000; ++k) {
    const std::string number = std::to_string(k);
    EXPECT_EQ(shifted_decimal(number, -3), std::stod(number + "e-3")) << k;
    if (shifted_decimal(number, -3) != k * 1e-3) ++rounded_twice;
  }
  EXPECT_GT(rounded_twice, 10);  // a product would not do
}

TEST(ShiftedDecimal, HasNothingForNumbersOutOfRange) {
  EXPECT_FALSE(shifted_decimal("1e400", 0));
  EXPECT_FALSE(shifted_decimal("1", 309));
  EXPECT_FALSE(shifted_decimal("1e-400", 0));
  EXPECT_FALSE(shifted_decimal("1e99999999999", 0));
  EXPECT_EQ(shifted_decimal("1e400", -400), 1.0);
  EXPECT_EQ(long_shifted_decimal("1e400", 0), 1e400L);
}

}  // namespace
}  // namespace peristat
