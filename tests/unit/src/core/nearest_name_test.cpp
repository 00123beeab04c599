#include "src/core/nearest_name.hpp"

#include <gtest/gtest.h>

namespace peristat {
namespace {

const std::vector<std::string> keys{"spacing", "horizon_ratio", "thickness", "origin", "shape"};

TEST(NearestName, IsTheNameItselfWhenItIsACandidate) {
  EXPECT_EQ(nearest_name("origin", keys), "origin");
}

TEST(NearestName, SurvivesOneInsertionDeletionOrReplacement) {
  EXPECT_EQ(nearest_name("sppacing", keys), "spacing");
  EXPECT_EQ(nearest_name("spcing", keys), "spacing");
  EXPECT_EQ(nearest_name("spocing", keys), "spacing");
}

TEST(NearestName, CountsASwapOfNeighboursAsOneEdit) {
  // Without swaps "abdc" would be two edits from "abcd" and one from "abdx".
  EXPECT_EQ(nearest_name("abdc", {"abcd", "abdx"}), "abcd");
  // Three swaps are within the limit of nine characters; six replacements would not be.
  EXPECT_EQ(nearest_name("bacdfegih", {"abcdefghi"}), "abcdefghi");
}

TEST(NearestName, PrefersTheLeastDistanceAndThenTheFirst) {
  EXPECT_EQ(nearest_name("shaped", {"shaken", "shape"}), "shape");
  EXPECT_EQ(nearest_name("cat", {"cut", "cot"}), "cut");
}

TEST(NearestName, AllowsAThirdOfALongName) {
  EXPECT_EQ(nearest_name("thicknezzz", {"thickness"}), "thickness");    // 3 edits, limit 3
  EXPECT_EQ(nearest_name("thzzknezzz", {"thickness"}), std::string());  // 5 edits
  EXPECT_EQ(nearest_name("orxxyn", keys), std::string());               // 3 edits, limit 2
}

TEST(NearestName, IsEmptyWhenNothingResembles) {
  EXPECT_EQ(nearest_name("poisson", keys), std::string());
  EXPECT_EQ(nearest_name("q", {"x", "y"}), std::string());
  EXPECT_EQ(nearest_name("anything", {}), std::string());
  EXPECT_EQ(nearest_name("", keys), std::string());
}

}  // namespace
}  // namespace peristat
