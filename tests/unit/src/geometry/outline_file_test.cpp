#include "src/geometry/outline_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

using Corners = std::vector<std::array<double, 2>>;

class OutlineFile : public testing::Test {
 protected:
  OutlineFile() : file_(std::filesystem::path(testing::TempDir()) / "outline_file_test.csv") {}
  ~OutlineFile() override { std::filesystem::remove(file_); }

  Corners read(const std::string& text) {
    std::ofstream(file_) << text;
    return read_outline(file_);
  }

  /// Place and message of the error, without the file's name.
  std::string refusal(const std::string& text) {
    try {
      static_cast<void>(read(text));
    } catch (const InputError& error) {
      return error.place().substr(std::min(error.place().size(), file_.string().size())) + " " +
             error.allowed();
    }
    return "nothing";
  }

 private:
  std::filesystem::path file_;
};

const Corners triangle{{0, 0}, {2.5e-3, 0}, {0, -1}};

TEST_F(OutlineFile, MayHaveCommasOrBlanksAHeaderAndComments) {
  EXPECT_EQ(read("0 0\n2.5e-3 0\n0 -1\n"), triangle);
  EXPECT_EQ(read("x,y\n0, 0\n# here\n\n2.5e-3 ,0\r\n+0,-1"), triangle);
  EXPECT_EQ(read("\xef\xbb\xbfx y\n0\t0\n2.5e-3 0\n0 -1\n"), triangle);
}

TEST_F(OutlineFile, MayEndWithItsFirstCorner) {
  EXPECT_EQ(read("0 0\n2.5e-3 0\n0 -1\n0 0\n"), triangle);
}

TEST_F(OutlineFile, IsRefusedWithTheLine) {
  EXPECT_EQ(refusal("0 0\n1 0 0\n0 1\n"), ":2 a corner has two numbers, x and y, not 3");
  EXPECT_EQ(refusal("0 0\n\n1\n"), ":3 a corner has two numbers, x and y, not 1");
  EXPECT_EQ(refusal("y x\n0 0\n"), ":1 x = 'y' is not a number");
  EXPECT_EQ(refusal("0 0\n1 nan\n"), ":2 y = 'nan' is not finite");
  EXPECT_EQ(refusal("0 0\n1 1e31\n"), ":2 y = '1e31' is out of range");
  EXPECT_EQ(refusal("0 0\n1 0\n"), " a polygon needs at least three corners");
  std::string many;
  for (int k = 0; k <= 10'000; ++k) many += "0 " + std::to_string(k) + "\n";
  EXPECT_TRUE(refusal(many).starts_with(":10001 there are more than 10000 corners"));
  EXPECT_EQ(refusal(""), " a polygon needs at least three corners");
  EXPECT_EQ(refusal("0 0\n1 0\n1 1\n0 0\n5 5\n6 5\n"),
            ":5 line 4 has closed the polygon by its first corner; a file has one polygon");
}

}  // namespace
}  // namespace peristat
