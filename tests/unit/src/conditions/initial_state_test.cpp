#include "src/conditions/initial_state.hpp"

#include <string>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "tests/problems.hpp"

namespace peristat {
namespace {

using tests::small_box;

TEST(InitialState, AddsUpAndNamesWhatIsNotFinite) {
  const Points points = tests::points_with_ends(small_box(2));
  const InitialState state =
      make_initial_state(points, {{"", {"x", "2"}, {"0", "1"}}, {"left", {"0", "0"}, {"3", "y"}}});
  const Index left = points.sets.at("left").front(), right = points.sets.at("right").front();
  const auto at = [](Index point, int component) {
    return std::size_t(point) * 2 + std::size_t(component);
  };
  EXPECT_EQ(state.displacement[at(right, 0)], points.position(right)[0]);
  EXPECT_EQ(state.displacement[at(right, 1)], 2.0);
  EXPECT_EQ(state.velocity[at(right, 0)], 0.0);
  EXPECT_EQ(state.velocity[at(left, 0)], 3.0);
  EXPECT_EQ(state.velocity[at(left, 1)], 1.0 + points.position(left)[1]);
  try {
    static_cast<void>(make_initial_state(points, {{"", {"0", "0"}, {"0", "sqrt(-1 - x)"}}}));
    FAIL() << "a velocity that is not finite";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "initial[0].velocity[1]");
    EXPECT_NE(std::string(error.what()).find("(x, y) = "), std::string::npos);
  }
  EXPECT_THROW(static_cast<void>(make_initial_state(points, {{"nobody"}})), InputError);
}

}  // namespace
}  // namespace peristat
