#include "src/conditions/absorption.hpp"

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

TEST(AbsorptionRates, OfSeveralLayersAddUp) {
  const Points points = tests::points_with_ends(tests::small_box(2));
  EXPECT_TRUE(absorption_rates(points, {}).empty());
  const std::vector<double> rates = absorption_rates(points, {{"", "2"}, {"left", "x + 1"}});
  ASSERT_EQ(rates.size(), std::size_t(points.count()));
  for (Index i = 0; i < points.count(); ++i) {
    const bool is_left = points.position(i)[0] < points.spacing;
    EXPECT_DOUBLE_EQ(rates[std::size_t(i)], is_left ? 3.0 + points.position(i)[0] : 2.0);
  }
}

TEST(AbsorptionRates, MustNotBeNegative) {
  const Points points = tests::points_with_ends(tests::small_box(1));
  try {
    static_cast<void>(absorption_rates(points, {{"", "1"}, {"right", "-x"}}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "absorbing[1].rate");
  }
}

}  // namespace
}  // namespace peristat
