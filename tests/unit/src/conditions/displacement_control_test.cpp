#include "src/conditions/displacement_control.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/conditions/conditions.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// Four points of a square, 2D.
Points square() {
  Points points;
  points.dimension = 2;
  points.spacing = 1.0;
  points.reference = {0, 0, 1, 0, 0, 1, 1, 1};
  points.volume = {1, 1, 1, 1};
  points.sets = {{"left", {0, 2}}, {"right", {1, 3}}, {"corner", {3}}, {"none", {}}};
  return points;
}

const std::vector<char> nothing_prescribed(8, 0);

TEST(DisplacementControl, AddsWeightedMeans) {
  const DisplacementControl opening(square(), {{"right", {1.0, 0.0}}, {"left", {-1.0, 0.5}}},
                                    nothing_prescribed);
  EXPECT_EQ(opening.weights(), (std::vector<double>{-0.5, 0.25, 0.5, 0, -0.5, 0.25, 0.5, 0}));
  //                                            left   right  left    right
  EXPECT_DOUBLE_EQ(opening.value(std::vector<double>{1, 2, 10, 3, 5, 4, 20, 7}),
                   15.0 - 3.0 + 0.5 * 3.0);
}

std::string refusal(const std::vector<ControlTerm>& terms,
                    const std::vector<char>& prescribed = nothing_prescribed) {
  try {
    static_cast<void>(DisplacementControl(square(), terms, prescribed));
  } catch (const InputError& error) {
    return error.key() + " " + error.what();
  }
  return "none";
}

TEST(DisplacementControl, RefusesWhatItCannotControl) {
  EXPECT_EQ(refusal({{"right", {1.0, 0.0}}, {"lft", {1.0, 0.0}}}).find("controls[1].set "), 0u);
  EXPECT_EQ(refusal({{"none", {1.0, 0.0}}}).find("controls[0].set "), 0u);
  EXPECT_EQ(refusal({{"right", {0.0, 0.0, 1.0}}}).find("controls[0].weights "), 0u);
  EXPECT_EQ(refusal({{"right", {std::numeric_limits<double>::infinity(), 0.0}}})
                .find("controls[0].weights "),
            0u);
  // One term takes the other away.
  EXPECT_EQ(refusal({{"right", {1.0, 0.0}}, {"right", {-1.0, 0.0}}}).find("controls "), 0u);
  // Supports hold all that is in the sum.
  const std::vector<char> right_held{0, 0, 1, 0, 0, 0, 1, 0};
  EXPECT_EQ(refusal({{"right", {1.0, 0.0}}}, right_held).find("controls "), 0u);
  EXPECT_EQ(refusal({{"right", {1.0, 1.0}}}, right_held), "none");
}

TEST(DisplacementControl, TakesThePlaceOfTheFirstLoadParameter) {
  const Points points = square();
  const Conditions conditions(
      points, {{"left", {"0.1*load + load2", "0"}}},
      {{LoadSpecification::Kind::total_force, "right", {"8*load", "0", "0"}}},
      LoadingProgramme({{0.0, 1e-3}, {0.0, 5.0}}), {{"right", {1.0, 0.0}}});
  ASSERT_NE(conditions.control(), nullptr);
  const LoadPoint at(0.5, 3.0);
  EXPECT_EQ(conditions.load_factor(at), 3.0);
  std::vector<double> values(8, 0.0);
  conditions.prescribe(at, values);
  EXPECT_DOUBLE_EQ(values[0], 0.3 + 2.5);
  conditions.external_force(at, values);
  EXPECT_DOUBLE_EQ(values[2], 12.0);
  EXPECT_EQ(Conditions(points, {}, {}).control(), nullptr);
}

}  // namespace
}  // namespace peristat
