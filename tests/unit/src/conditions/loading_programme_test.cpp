#include "src/conditions/loading_programme.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

TEST(LoadingProgramme, LeadsFrom0To1WithoutTables) {
  const LoadingProgramme programme;
  EXPECT_EQ(programme.end(), 1.0);
  EXPECT_EQ(programme.parameters(), 1u);
  for (const double stage : {0.0, 0.1, 1.0 / 3.0, 0.7, 0.9999999999999999, 1.0}) {
    EXPECT_EQ(programme.at(stage), std::vector<double>{stage});  // to the last bit
  }
}

TEST(LoadingProgramme, GoesLinearlyFromEntryToEntry) {
  const LoadingProgramme programme({{0.0, 1.0, 1.0, -0.5}, {0.0, 0.0, 0.1, 0.3}});
  EXPECT_EQ(programme.end(), 3.0);
  EXPECT_EQ(programme.at(0.25), (std::vector<double>{0.25, 0.0}));
  EXPECT_EQ(programme.at(1.5), (std::vector<double>{1.0, 0.05}));
  EXPECT_EQ(programme.at(2.5), (std::vector<double>{0.25, 0.2}));
  // Entries are reached exactly.
  EXPECT_EQ(programme.at(1.0), (std::vector<double>{1.0, 0.0}));
  EXPECT_EQ(programme.at(2.0), (std::vector<double>{1.0, 0.1}));
  EXPECT_EQ(programme.at(3.0), (std::vector<double>{-0.5, 0.3}));
}

TEST(LoadingProgramme, KnowsTheNextEntry) {
  EXPECT_EQ(LoadingProgramme::next_entry(0.0), 1.0);
  EXPECT_EQ(LoadingProgramme::next_entry(0.999), 1.0);
  EXPECT_EQ(LoadingProgramme::next_entry(1.0), 2.0);
  EXPECT_EQ(LoadingProgramme::next_entry(1.0 - 1e-12), 2.0);  // round-off of a sum of steps
  EXPECT_EQ(LoadingProgramme::next_entry(1.0 + 1e-12), 2.0);
  const LoadingProgramme programme({{0.0, 1.0, 0.0}});
  EXPECT_TRUE(programme.has_rest(1.9));
  EXPECT_FALSE(programme.has_rest(2.0));
  EXPECT_FALSE(programme.has_rest(2.0 - 1e-12));
}

std::string refusal(std::vector<std::vector<double>> tables) {
  try {
    LoadingProgramme(std::move(tables));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LoadingProgramme, RefusesTablesThatDoNotGoTogether) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal({{0.5, 1.0}}),
            "programme[0] = 0.5: must begin with 0: the body starts at rest, without loads");
  EXPECT_EQ(refusal({{0.0}}), "programme[0]: needs at least two entries");
  EXPECT_EQ(refusal({{0.0, 1.0}, {0.0, 1.0, 2.0}}),
            "programme[1]: has 3 entries, but the first table has 2");
  EXPECT_EQ(refusal({{0.0, infinite}}), "programme[0] = inf: must be finite");
  EXPECT_EQ(refusal({}), "programme = 0: must have from 1 to 4 tables");
  EXPECT_EQ(refusal({{0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}}),
            "programme = 5: must have from 1 to 4 tables");
}

TEST(LoadingProgramme, IsOfTime) {
  const LoadingProgramme programme = LoadingProgramme::of_time(2.5);
  EXPECT_TRUE(programme.is_of_time());
  EXPECT_EQ(programme.names(), std::vector<std::string>{"t"});
  EXPECT_EQ(programme.at(1.75), std::vector<double>{1.75});
  EXPECT_EQ(programme.end(), 2.5);
  EXPECT_TRUE(programme.has_rest(2.5 * (1.0 - 1e-12)));
  EXPECT_FALSE(programme.has_rest(2.5));
  EXPECT_FALSE(LoadingProgramme().is_of_time());
  EXPECT_EQ(LoadingProgramme().names(), std::vector<std::string>{"load"});
  for (const double end : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(static_cast<void>(LoadingProgramme::of_time(end)), InputError);
  }
}

TEST(LoadingProgramme, HasLoadsOverTime) {
  const LoadingProgramme programme =
      LoadingProgramme::of_time(4.0, {{{0, 2}, {1, 3}, {4, -3}}, {{0, 0}, {8, 16}}});
  EXPECT_EQ(programme.names(), (std::vector<std::string>{"t", "load", "load2"}));
  EXPECT_EQ(programme.at(0.0), (std::vector<double>{0.0, 2.0, 0.0}));
  EXPECT_EQ(programme.at(0.5), (std::vector<double>{0.5, 2.5, 1.0}));
  EXPECT_EQ(programme.at(1.0), (std::vector<double>{1.0, 3.0, 2.0}));  // exactly
  EXPECT_EQ(programme.at(2.5), (std::vector<double>{2.5, 0.0, 5.0}));
  EXPECT_EQ(programme.at(4.0), (std::vector<double>{4.0, -3.0, 8.0}));
  EXPECT_EQ(programme.end(), 4.0);
}

TEST(LoadingProgramme, RefusesLoadsThatDoNotCoverTheMotion) {
  const auto refused = [](const std::vector<TimeTable>& loads) -> std::string {
    try {
      static_cast<void>(LoadingProgramme::of_time(2.0, loads));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refused({{{0, 0}, {2, 1}}}), "accepted");
  EXPECT_EQ(refused({{{0, 0}}}), "programme[0]: needs at least two pairs of a time and a value");
  EXPECT_EQ(refused({{{1, 0}, {2, 1}}}), "programme[0] = 1: must begin at the time 0");
  EXPECT_EQ(refused({{{0, 0}, {2, 1}}, {{0, 0}, {2, 1}, {2, 2}}}),
            "programme[1] = 2: must be later than the time before, 2 s: the times of a table "
            "ascend");
  EXPECT_EQ(refused({{{0, 0}, {2, infinite}}}), "programme[0] = inf: must be finite");
  EXPECT_EQ(refused({{{0, 0}, {1.5, 1}}}),
            "programme[0] = 1.5: ends before the motion, which ends at 2 s; add a pair for the "
            "value from there on");
  EXPECT_EQ(refused(std::vector<TimeTable>(5, {{0, 0}, {2, 1}})),
            "programme = 5: must have at most 4 tables");
}

}  // namespace
}  // namespace peristat
