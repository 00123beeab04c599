#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/commands/unknown_option.hpp"
#include "cases/runner/process/folded_text.hpp"
#include "cases/runner/process/time_left.hpp"

namespace peristat {
namespace {

TEST(Folded, BreaksAtSpacesAndIndents) {
  EXPECT_EQ(folded("short", 10), "short");
  EXPECT_EQ(folded("  one two three", 9), "  one two\n      three");
  EXPECT_EQ(folded("aaaaaaaaaaaa b", 5), "aaaaaaaaaaaa\n    b");  // a word stays whole
  EXPECT_EQ(folded("µµµµ µµµµ", 5), "µµµµ\n    µµµµ");
  EXPECT_EQ(folded("", 5), "");
  for (std::size_t width = 1; width < 40; ++width) {
    const std::string text = "  step 12  load 0.5  and more words of a line that is long";
    std::string joined = folded(text, width);
    for (std::size_t at; (at = joined.find('\n')) != std::string::npos;) {
      joined.replace(at, joined.find_first_not_of(" \n", at) - at, " ");
    }
    std::string without;  // runs of spaces may have been where a line ends
    for (const char c : joined) {
      if (c != ' ') without += c;
    }
    EXPECT_EQ(without, "step12load0.5andmorewordsofalinethatislong") << width;
  }
}

TEST(CutTo, KeepsWholeCharacters) {
  EXPECT_EQ(cut_to("µm or more", 1), "µ");
  EXPECT_EQ(cut_to("abc", 3), "abc");
}

TEST(TimeLeft, IsThatOfTheLastStepsAndSilentAtFirst) {
  TimeLeft left;
  for (int step = 1; step <= 3; ++step) {
    left.accepted(10.0 * step, 0.01 * step, false);
    EXPECT_FALSE(left.seconds());
  }
  left.accepted(40.0, 0.04, false);
  ASSERT_TRUE(left.seconds());
  EXPECT_NEAR(*left.seconds(), 960.0, 1e-9);  // 0.001 per second
  for (int step = 1; step <= 20; ++step) {
    left.accepted(40.0 + 100.0 * step, 0.04 + 0.01 * step, false);
  }
  EXPECT_NEAR(*left.seconds(), 7600.0, 1e-6);  // what was faster is forgotten
}

TEST(TimeLeft, SaysNothingWhileTheRateChangesOrBondsBreak) {
  TimeLeft slowing;
  for (int step = 1; step <= 8; ++step) slowing.accepted(std::pow(3.0, step), 0.1 * step, false);
  EXPECT_FALSE(slowing.seconds());
  TimeLeft breaking;
  for (int step = 1; step <= 8; ++step) breaking.accepted(step, 0.1 * step, step == 8);
  EXPECT_FALSE(breaking.seconds());
  TimeLeft instant;
  for (int step = 1; step <= 8; ++step) instant.accepted(0.0, 0.1 * step, false);
  EXPECT_FALSE(instant.seconds());
}

TEST(DescribeUnknown, NamesTheKeyOrTheOptionThatWasMeant) {
  const std::vector<std::string> options{"--threads", "--output", "--quiet"};
  EXPECT_EQ(describe_unknown({"--steps", "3"}, options, true),
            "unknown option --steps; did you mean --set loading.steps=3 or --set "
            "relaxation.steps=3?");
  EXPECT_EQ(describe_unknown({"--spacing=1e-3"}, options, true),
            "unknown option --spacing; did you mean --set lattice.spacing=1e-3?");
  EXPECT_EQ(describe_unknown({"--horizon-ratio", "3"}, options, true),
            "unknown option --horizon-ratio; did you mean --set lattice.horizon_ratio=3?");
  EXPECT_EQ(describe_unknown({"--thread", "3"}, options, true),
            "unknown option --thread; did you mean --threads?");
  EXPECT_EQ(describe_unknown({"--steps", "3"}, options, false), "unknown option --steps");
  EXPECT_EQ(describe_unknown({"more.toml"}, options, true), "\"more.toml\" is not expected here");
}

}  // namespace
}  // namespace peristat
