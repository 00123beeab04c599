#include "src/geometry/neighbour_file.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "src/core/input_error.hpp"
#include "src/geometry/point_file.hpp"

namespace peristat {
namespace {

class NeighbourFileTest : public ::testing::Test {
 protected:
  NeighbourFileTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("peristat_neighbour_file_" + std::to_string(getpid()) + "_" + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~NeighbourFileTest() override { std::filesystem::remove_all(folder_); }

  /// Four points in a row, numbered from right to left in their file.
  Points read(const std::string& text) const {
    std::ofstream(folder_ / "points.csv") << "x, volume\n3, 0.5\n2, 0.5\n1, 2\n0, 0.5\n";
    std::ofstream(file(), std::ios::binary) << text;
    return read_points(folder_ / "points.csv", 1, 1.0, NeighbourFile{file(), 1.0, 1.0});
  }

  std::filesystem::path file() const { return folder_ / "neighbours.csv"; }

  /// Line and message with which a text is refused; line 0 if it is accepted.
  std::pair<int, std::string> refusal(const std::string& text) const {
    try {
      (void)read(text);
    } catch (const InputError& error) {
      const std::string message = error.what(), before = file().string() + ":";
      if (!message.starts_with(before)) return {-1, message};
      return {std::stoi(message.substr(before.size())), error.allowed()};
    }
    return {0, "accepted"};
  }

  std::filesystem::path folder_;
};

TEST_F(NeighbourFileTest, FollowsThePointsToTheirNewNumbers) {
  const Points points = read("# by hand\ni, j, w_ij, w_ji\n1, 2, 0.5, 0.25\n\n4, 3, 1, 0.75\n");
  ASSERT_EQ(points.reference, (std::vector<double>{0, 1, 2, 3}));
  ASSERT_EQ(points.neighbours.size(), 2u);
  // File's 4 and 3 are points 0 and 1 now: w_43 = 1 is of point 1's volume, w_34 of point 0's.
  EXPECT_EQ(points.neighbours[0].i, 0);
  EXPECT_EQ(points.neighbours[0].j, 1);
  EXPECT_EQ(points.neighbours[0].of_j, 1.0);
  EXPECT_EQ(points.neighbours[0].of_i, 0.75);
  // File's 1 and 2 are points 3 and 2: the pair has turned round.
  EXPECT_EQ(points.neighbours[1].i, 2);
  EXPECT_EQ(points.neighbours[1].j, 3);
  EXPECT_EQ(points.neighbours[1].of_j, 0.25);
  EXPECT_EQ(points.neighbours[1].of_i, 0.5);
}

TEST_F(NeighbourFileTest, TakesEachPairOnceOrInBothDirections) {
  const Points once = read("i j w_ij\n1 2 0.5\n3 4 1\n");
  EXPECT_EQ(once.neighbours[1].of_j, 0.5);
  EXPECT_EQ(once.neighbours[1].of_i, 0.5);
  const Points both = read("i j w_ij\n1 2 0.5\n2 1 0.25\n3 4 1\n4 3 1\n");
  EXPECT_EQ(both.neighbours[1].of_j, 0.25);
  EXPECT_EQ(both.neighbours[1].of_i, 0.5);
}

TEST_F(NeighbourFileTest, RefusesARowThatCannotBeMeant) {
  const std::string head = "i, j, w_ij\n1, 2, 1\n";
  const std::vector<std::pair<std::string, std::string>> rows{
      {"0, 1, 1", "not a point"},       {"1, 5, 1", "not a point"},
      {"1.5, 2, 1", "not a point"},     {"x, 2, 1", "not a number"},
      {"3, 3, 1", "its own"},           {"1, 2, 1", "already neighbours in line 2"},
      {"3, 4, nan", "not finite"},      {"3, 4, inf", "not finite"},
      {"3, 4, 1e999", "range"},         {"3, 4, -0.1", "from 0 to 1"},
      {"3, 4, 1.1", "from 0 to 1"},     {"3, 4, 0", "share of 0"},
      {"3, 4", "2 values for 3"},       {"3, 4, 1, 1", "4 values for 3"},
      {"1, 4, 1", "beyond the horizon"}};
  for (const auto& [row, words] : rows) {
    const auto [line, message] = refusal(head + row + "\n");
    EXPECT_EQ(line, 3) << row << ": " << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
  const auto [line, message] = refusal("i, j, w_ij\n1, 2, 1\n2, 1, 1\n3, 4, 1\n");
  EXPECT_EQ(line, 4);
  EXPECT_NE(message.find("one direction"), std::string::npos) << message;
  EXPECT_EQ(refusal("i, j, w_ij, w_ji\n1, 2, 1, 1\n2, 1, 1, 1\n").first, 3);
  EXPECT_EQ(refusal("i, j, area\n1, 2, 1\n").first, 1);
  EXPECT_EQ(refusal("i, j\n1, 2\n").first, 1);
  EXPECT_EQ(refusal("").first, -1);
  EXPECT_EQ(refusal("i, j, w_ij\n").first, -1);
}

// A cell that the horizon reaches into counts though its place lies beyond: half a diagonal, which
// is half its length in 1D. Points 1 and 3 are 2 apart, and the larger cell is 2 long.
TEST_F(NeighbourFileTest, TakesACellThatTheHorizonReaches) {
  EXPECT_EQ(refusal("i, j, w_ij\n1, 3, 0.5\n").first, 0);
  EXPECT_EQ(refusal("i, j, w_ij\n2, 4, 0.5\n").first, 2);
}

}  // namespace
}  // namespace peristat
