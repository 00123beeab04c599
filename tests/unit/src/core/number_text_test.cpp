#include "src/core/number_text.hpp"

#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

namespace peristat {
namespace {

TEST(NumberText, IsShortAndReadsBackAsTheSameNumber) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(-3.0), "-3");
  for (const double value : {1.0 / 3.0, 1e-300, -6.02214076e23, 5e-324}) {
    EXPECT_EQ(std::strtod(number_text(value).c_str(), nullptr), value);
  }
}

TEST(NumberText, WritesValuesThatAreNotFinite) {
  EXPECT_EQ(number_text(-std::numeric_limits<double>::infinity()), "-inf");
  EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(PlaceText, HasTheComponentsOfTheDimension) {
  EXPECT_EQ(place_text({0.5, -1.0, 2.0}, 1), "(0.5)");
  EXPECT_EQ(place_text({0.5, -1.0, 2.0}, 3), "(0.5, -1, 2)");
}

}  // namespace
}  // namespace peristat
