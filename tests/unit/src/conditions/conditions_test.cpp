#include "src/conditions/conditions.hpp"

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// Four points on a diagonal with unequal volumes, and sets of them.
Points four_points(int dimension = 2) {
  Points points;
  points.dimension = dimension;
  points.spacing = 0.5;
  for (int i = 0; i < 4; ++i) {
    for (int c = 0; c < dimension; ++c) points.reference.push_back(i + 10.0 * c);
    points.volume.push_back(1.0 + i);
  }
  points.sets = {{"first", {0}}, {"left", {0, 1}}, {"middle", {1, 2}}, {"none", {}}};
  return points;
}

/// A support; components that are not given are free.
SupportSpecification support(std::string set, std::optional<std::string> x,
                             std::optional<std::string> y = std::nullopt) {
  return {std::move(set), {std::move(x), std::move(y), std::nullopt}};
}

LoadSpecification load(LoadSpecification::Kind kind, std::string set,
                       std::array<std::string, 3> value) {
  return {kind, std::move(set), std::move(value)};
}

constexpr auto body_force = LoadSpecification::Kind::body_force;
constexpr auto total_force = LoadSpecification::Kind::total_force;

InputError refusal(const std::function<void()>& make) {
  try {
    make();
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was refused";
  return InputError("", "", "");
}

TEST(Conditions, PrescribesOnlyTheGivenComponents) {
  const Points points = four_points();
  const Conditions conditions(
      points, {support("left", "0.1*x + load"), support("first", std::nullopt, "2*spacing")}, {});
  EXPECT_EQ(conditions.prescribed(), (std::vector<char>{1, 1, 1, 0, 0, 0, 0, 0}));
  std::vector<double> displacement(8, 7.0);
  conditions.prescribe(0.5, displacement);
  EXPECT_EQ(displacement, (std::vector<double>{0.5, 1.0, 0.6, 7.0, 7.0, 7.0, 7.0, 7.0}));
}

TEST(Conditions, BodyForceActsOnEveryVolumeAtItsPlace) {
  const Points points = four_points();
  const Conditions conditions(points, {},
                              {load(body_force, "middle", {"x*load", "y", "0"}),
                               load(body_force, "left", {"3", "0", "0"})});
  std::vector<double> force(8, -1.0);
  conditions.external_force(0.5, force);
  // Point 1 (volume 2) at (1, 11), point 2 (volume 3) at (2, 12).
  EXPECT_EQ(force, (std::vector<double>{3.0, 0.0, 2 * 0.5 + 2 * 3.0, 2 * 11.0, 3 * 1.0, 3 * 12.0,
                                        0.0, 0.0}));
}

TEST(Conditions, TotalForceIsSpreadInProportionToVolume) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const Points points = four_points(dimension);
    const Conditions conditions(points, {}, {load(total_force, "middle", {"10*load", "-5", "1"})});
    std::vector<double> force(points.reference.size());
    conditions.external_force(0.5, force);
    const double total[3] = {5.0, -5.0, 1.0};
    for (int c = 0; c < dimension; ++c) {
      EXPECT_DOUBLE_EQ(force[std::size_t(1) * dimension + c], total[c] * 2.0 / 5.0);
      EXPECT_DOUBLE_EQ(force[std::size_t(2) * dimension + c], total[c] * 3.0 / 5.0);
      EXPECT_EQ(force[c], 0.0);
      EXPECT_EQ(force[std::size_t(3) * dimension + c], 0.0);
    }
  }
}

TEST(Conditions, ReactionsAreWhatTheSupportsAdd) {
  const Points points = four_points();
  const Conditions conditions(points,
                              {support("left", "0"), support("middle", std::nullopt, "load")}, {});
  const std::vector<double> gradient{1, 2, 4, 8, 16, 32, 64, 128};
  const std::vector<double> external{0.5, 0, 0.25, 0.125, 0, 0, 0, 0};
  const auto reactions = conditions.reactions(gradient, external, {}, nullptr);
  ASSERT_EQ(reactions.size(), 2u);
  EXPECT_EQ(reactions.at("left"), (Coordinates{(1 - 0.5) + (4 - 0.25), 0, 0}));
  EXPECT_EQ(reactions.at("middle"), (Coordinates{0, (8 - 0.125) + 32, 0}));
}

TEST(Conditions, ReactionsOfASetThatIsSupportedTwiceCountOnce) {
  const Points points = four_points();
  const std::vector<double> gradient{1, 2, 4, 8, 16, 32, 64, 128};
  const std::vector<double> external(8, 0.0);
  const auto reactions = [&](const std::vector<SupportSpecification>& supports) {
    return Conditions(points, supports, {}).reactions(gradient, external, {}, nullptr);
  };
  const auto once = reactions({support("left", "0", "0")});
  EXPECT_EQ(reactions({support("left", "0", "0"), support("left", "0", "0")}), once);
  EXPECT_EQ(reactions({support("left", "0"), support("left", std::nullopt, "0")}), once);
  EXPECT_EQ(reactions({support("left", "0", "0"), support("left", "0*load")}), once);
}

TEST(Conditions, TakesSupportsThatAgreeWhereTheyOverlap) {
  const Points points = four_points();
  EXPECT_NO_THROW(Conditions(points, {support("left", "x*load"), support("middle", "load")},
                             {}));  // both 1 at x = 1
  EXPECT_NO_THROW(
      Conditions(points, {support("left", "1"), support("middle", std::nullopt, "2")}, {}));
}

TEST(Conditions, RefusesSupportsThatContradictEachOther) {
  const Points points = four_points();
  const auto make = [&](const std::string& one, const std::string& other) {
    return refusal([&] {
      Conditions(points, {support("left", one), support("middle", other)}, {});
    });
  };
  const InputError error = make("0.25", "x");
  EXPECT_EQ(error.key(), "supports[1].displacement[0]");
  for (const char* told : {"left", "middle", "contradict", "in x", "(1,", "0.25"}) {
    EXPECT_NE(error.allowed().find(told), std::string::npos) << told << ": " << error.allowed();
  }
  make("load", "1.5*load");      // at the end
  make("load*(1 - load)", "0");  // only on the way
  make("1", "1 - load");         // not at the start
  make("load*(load - 0.5)*(load - 1)", "0");
}

TEST(Conditions, RefusesContradictionsWhereverTheyAreUsed) {
  const Points points = four_points();
  const Conditions conditions(
      points, {support("left", "load"), support("middle", "load + (abs(load - 0.42) < 1e-9)")}, {});
  std::vector<double> displacement(8);
  EXPECT_NO_THROW(conditions.prescribe(0.41, displacement));
  const InputError error = refusal([&] { conditions.prescribe(0.42, displacement); });
  EXPECT_EQ(error.key(), "supports[1].displacement[0]");
  EXPECT_NE(error.allowed().find("0.42 m by the first and 1.42 m by the second"), std::string::npos)
      << error.allowed();
}

TEST(Conditions, TakesExpressionsThatDifferInTheirLastDigits) {
  const Points points = four_points();
  const Conditions conditions(points,
                              {support("left", "1e-5*load*3"), support("middle", "3e-5*load")}, {});
  std::vector<double> displacement(8);
  for (int k = 0; k <= 100; ++k) EXPECT_NO_THROW(conditions.prescribe(0.01 * k, displacement));
  EXPECT_NEAR(displacement[2], 3e-5, 1e-17);
}

TEST(Conditions, RefusesUnknownAndEmptySets) {
  const Points points = four_points();
  const InputError unknown = refusal([&] {
    Conditions(points, {support("first", "0"), support("riht", "0")}, {});
  });
  EXPECT_EQ(unknown.key(), "supports[1].set");
  EXPECT_EQ(unknown.value(), "\"riht\"");
  EXPECT_NE(unknown.allowed().find("middle"), std::string::npos);
  const InputError empty = refusal([&] {
    Conditions(points, {}, {load(body_force, "none", {"0", "0", "0"})});
  });
  EXPECT_EQ(empty.key(), "loads[0].set");
  EXPECT_NE(empty.allowed().find("no point"), std::string::npos);
}

TEST(Conditions, NamesTheKeyOfABadExpression) {
  const Points points = four_points();
  EXPECT_EQ(refusal([&] { Conditions(points, {support("left", "2*q")}, {}); }).key(),
            "supports[0].displacement[0]");
  EXPECT_EQ(refusal([&] {
              Conditions(points, {}, {load(body_force, "left", {"(", "0", "0"})});
            }).key(),
            "loads[0].value[0]");
  // A total force has no place.
  EXPECT_EQ(refusal([&] {
              Conditions(points, {}, {load(total_force, "left", {"x", "0", "0"})});
            }).key(),
            "loads[0].value[0]");
}

TEST(Conditions, TellsWhereATotalForceIsNotFinite) {
  const Points points = four_points();
  const Conditions conditions(points, {},
                              {load(total_force, "left", {"1/(load - 0.5)", "0", "0"})});
  std::vector<double> force(8);
  conditions.external_force(0.25, force);
  EXPECT_LT(force[0], 0.0);
  const InputError error = refusal([&] { conditions.external_force(0.5, force); });
  EXPECT_EQ(error.allowed(), "the value at load = 0.5 is inf; it must be finite");
}

}  // namespace
}  // namespace peristat
