#include "src/core/vector_verbs.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace peristat {
namespace {

/// 1, 2, …, count.
std::vector<double> numbers(std::size_t count) {
  std::vector<double> all(count);
  for (std::size_t k = 0; k < count; ++k) all[k] = double(k + 1);
  return all;
}

TEST(VectorVerbs, SumEveryEntryOnceWhateverTheirCount) {
  for (const std::size_t count : {0, 1, 15, 16, 17, 31, 32, 100}) {
    const std::vector<double> all = numbers(count), ones(count, 1.0);
    const double n = double(count);
    EXPECT_EQ(dot(all, ones), n * (n + 1.0) / 2.0) << count;
    EXPECT_DOUBLE_EQ(norm(all), std::sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 6.0)) << count;
  }
}

TEST(VectorVerbs, KeepNormsWhoseSquaresLeaveTheRange) {
  for (const double scale : {1e-310, 1e-200, 1e200, 1e306}) {
    std::vector<double> all = numbers(20);
    for (double& entry : all) entry *= scale;
    EXPECT_NEAR(norm(all) / scale, std::sqrt(2870.0), 1e-9) << scale;
  }
  EXPECT_EQ(norm(std::vector<double>(20, 0.0)), 0.0);
}

TEST(VectorVerbs, TellNormsThatAreNotFinite) {
  std::vector<double> all = numbers(20);
  all[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(norm(all)));
  all[3] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(std::isfinite(norm(all)));
}

}  // namespace
}  // namespace peristat
