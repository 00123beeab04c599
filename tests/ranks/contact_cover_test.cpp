#include "assembly/terms/contact/contact_cover.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/ranks/parts_on_ranks.hpp"

namespace peristat::tests {
namespace {

constexpr double spacing = 0.1, middle = 0.3 + 20 * spacing;

/// A displacement of a bar's upper half along it.
std::vector<double> upper_half_by(const Points& points, double step) {
  std::vector<double> u(points.reference.size(), 0.0);
  for (std::size_t k = 0; k < u.size(); ++k) {
    if (points.reference[k] > middle) u[k] = step;
  }
  return u;
}

TEST(ContactCover, sees_points_of_other_ranks_that_come_near) {
  const OnRanks here(bar(), SurfaceCorrection::none);
  ContactCover cover(here.part.points, here.index_map, spacing, 2.0 * spacing);
  const bool is_whole = all_ranks().count() == 1;
  const auto holds = [&](double step) {
    return cover.holds(upper_half_by(here.part.points, step));
  };
  for (int round = 0; round < 2; ++round) {  // what has been asked before changes no answer
    EXPECT_TRUE(holds(0.0));
    EXPECT_TRUE(holds(5.0 * spacing));            // apart
    EXPECT_TRUE(holds(-0.4 * spacing));           // neighbours of the reference, which are ghosts
    EXPECT_EQ(holds(-20.0 * spacing), is_whole);  // one half on the other
    EXPECT_TRUE(holds(-42.0 * spacing));          // beyond the other
    EXPECT_EQ(holds(-39.5 * spacing), is_whole);
    EXPECT_TRUE(holds(std::numeric_limits<double>::quiet_NaN()));  // no matter of contact
  }
}

TEST(ContactCover, sees_points_of_other_ranks_that_pass) {
  const OnRanks here(bar(), SurfaceCorrection::none);
  ContactCover cover(here.part.points, here.index_map, spacing, 2.0 * spacing);
  const bool is_whole = all_ranks().count() == 1;
  const std::vector<double> rest = upper_half_by(here.part.points, 0.0);
  const auto leaves = [&](double step) {
    return cover.is_left_by(rest, upper_half_by(here.part.points, step));
  };
  EXPECT_FALSE(leaves(30.0 * spacing));
  EXPECT_FALSE(leaves(-0.4 * spacing));
  EXPECT_EQ(leaves(-42.0 * spacing), !is_whole);
}

TEST(ContactCover, is_wide_where_ghosts_reach_far) {
  RanksBody body = bar();
  body.horizon_ratio = 50.015;
  const OnRanks here(body, SurfaceCorrection::none);
  ContactCover cover(here.part.points, here.index_map, spacing, 2.0 * spacing);
  EXPECT_TRUE(cover.holds(upper_half_by(here.part.points, -20.0 * spacing)));
  EXPECT_FALSE(cover.is_left_by(upper_half_by(here.part.points, 0.0),
                                upper_half_by(here.part.points, -42.0 * spacing)));
}

}  // namespace
}  // namespace peristat::tests
