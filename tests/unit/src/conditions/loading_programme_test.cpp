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

}  // namespace
}  // namespace peristat
