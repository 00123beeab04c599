#include "src/core/dual.hpp"

#include <gtest/gtest.h>

namespace peristat {
namespace {

TEST(Dual, HasTheRatesOfSumsAndProducts) {
  // a = 3 + 2 t, b = 5 - t
  const Dual a(3.0, 2.0), b(5.0, -1.0);
  const Dual polynomial = a * a * b - Dual(2.0) * b + a;
  EXPECT_EQ(polynomial.value, 3.0 * 3.0 * 5.0 - 10.0 + 3.0);
  EXPECT_EQ(polynomial.rate, 2.0 * 3.0 * 2.0 * 5.0 - 9.0 + 2.0 + 2.0);
  Dual sum = a;
  sum += b;
  sum -= Dual(1.0);
  EXPECT_EQ(sum.value, 7.0);
  EXPECT_EQ(sum.rate, 1.0);
}

}  // namespace
}  // namespace peristat
