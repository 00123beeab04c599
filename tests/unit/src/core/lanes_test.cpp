#include "src/core/lanes.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace peristat {
namespace {

constexpr double a_row[] = {3.0, -1.0, 0.25, -0.0}, b_row[] = {1.0, 2.0, 0.25, -5.0};

class LanesTest : public testing::Test {
 protected:
  /// Lane by lane the same as of numbers.
  template <class Verb>
  void expect_same(const Verb& verb) {
    const Lanes found = verb(a, b);
    for (int l = 0; l < lane_count; ++l) {
      EXPECT_EQ(found[l], verb(a_row[l], b_row[l])) << l;
    }
  }
  const Lanes a{a_row}, b{b_row};
};

TEST_F(LanesTest, CountAsNumbersDo) {
  expect_same([](auto x, auto y) { return x + y; });
  expect_same([](auto x, auto y) { return x - 2.0 * y; });
  expect_same([](auto x, auto y) { return x * y; });
  expect_same([](auto x, auto y) { return x / y; });
  expect_same([](auto x, auto y) { return -x * 3.0 / y; });
  expect_same([](auto x, auto y) {
    x += y;
    x *= y;
    x -= 1.0;
    x /= y;
    return x;
  });
}

TEST_F(LanesTest, HaveTheFunctionsOfNumbers) {
  using std::abs, std::max, std::min, std::sqrt;
  expect_same([](auto x, auto y) { return min(x, y); });
  expect_same([](auto x, auto y) { return max(x, y); });
  expect_same([](auto x, auto) { return abs(x); });
  expect_same([](auto, auto y) { return sqrt(y * y); });
  EXPECT_FALSE(std::signbit(abs(a)[3]));  // of minus zero
}

TEST_F(LanesTest, CompareLaneByLane) {
  const LaneMask less = a<b, more = a> b, least = a <= b, most = a >= b;
  for (int l = 0; l < lane_count; ++l) {
    EXPECT_EQ(less[l], a_row[l] < b_row[l]);
    EXPECT_EQ(more[l], a_row[l] > b_row[l]);
    EXPECT_EQ(least[l], a_row[l] <= b_row[l]);
    EXPECT_EQ(most[l], a_row[l] >= b_row[l]);
    EXPECT_EQ((!less)[l], !(a_row[l] < b_row[l]));
    EXPECT_FALSE((less && more)[l]);
    EXPECT_EQ((less || more)[l], a_row[l] != b_row[l]);
  }
}

TEST_F(LanesTest, TellWhetherAnyIsMeant) {
  for (int one = 0; one < lane_count; ++one) {
    const LaneMask only = Lanes([&](int l) { return l == one ? 1.0 : 0.0; }) > 0.5;
    EXPECT_TRUE(any_of(only)) << one;
    EXPECT_FALSE(none_of(only)) << one;
  }
  EXPECT_TRUE(none_of(a > 7.0));
  EXPECT_TRUE(any_of(!(a > 7.0)));
}

TEST_F(LanesTest, AreChosenByAMask) {
  const Lanes found = chosen(a < b, 9.0, a);
  for (int l = 0; l < lane_count; ++l) {
    EXPECT_EQ(found[l], a_row[l] < b_row[l] ? 9.0 : a_row[l]);
  }
}

TEST_F(LanesTest, AreGatheredInOneOrder) {
  EXPECT_EQ(largest(a), 3.0);
  EXPECT_EQ(smallest(b), -5.0);
  const Lanes apart([](int l) { return l == 0 ? 1e16 : l == 2 ? -1e16 : 1.0; });
  EXPECT_EQ(sum(apart), 2.0);  // (0 + 2) + (1 + 3)
}

TEST_F(LanesTest, AreReadAndWritten) {
  double row[lane_count + 1] = {};
  Lanes changed = a;
  changed.set(2, 8.0);
  changed.copy_to(row + 1);  // no alignment is asked for
  EXPECT_EQ(row[0], 0.0);
  EXPECT_EQ(row[1], a_row[0]);
  EXPECT_EQ(row[3], 8.0);
  EXPECT_EQ(Lanes(row + 1)[2], 8.0);
  EXPECT_EQ(Lanes(2.5)[3], 2.5);
}

}  // namespace
}  // namespace peristat
