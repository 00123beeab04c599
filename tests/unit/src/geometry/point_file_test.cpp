#include "src/geometry/point_file.hpp"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

class PointFile : public ::testing::Test {
 protected:
  PointFile() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("peristat_point_file_" + std::to_string(getpid()) + "_" + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~PointFile() override { std::filesystem::remove_all(folder_); }

  Points read(const std::string& text, int dimension = 2, double cross_section = 1.0) const {
    std::ofstream(file(), std::ios::binary) << text;
    return read_points(file(), dimension, cross_section);
  }

  std::filesystem::path file() const { return folder_ / "points.csv"; }

  /// Line and message with which a text is refused; line 0 if it is accepted.
  std::pair<int, std::string> refusal(const std::string& text, int dimension = 2) const {
    try {
      (void)read(text, dimension);
    } catch (const InputError& error) {
      const std::string message = error.what(), before = file().string() + ":";
      if (!message.starts_with(before)) return {-1, message};
      return {std::stoi(message.substr(before.size())), error.allowed()};
    }
    return {0, "accepted"};
  }

  std::filesystem::path folder_;
};

TEST_F(PointFile, IsInTheUnitOfLengthToTheLastBit) {
  const std::string text = "x,y,volume\n0.1,0.3,0.7\n1.1,-2.5e0,0.7\n";
  static_cast<void>(read(text));
  const auto in_unit = [&](double unit) { return read_points(file(), 2, unit, {}, unit); };
  const Points mm = in_unit(1e-3), um = in_unit(1e-6), inches = in_unit(0.0254);
  EXPECT_EQ(mm.reference, (std::vector<double>{1e-4, 3e-4, 1.1e-3, -2.5e-3}));
  EXPECT_EQ(mm.volume, (std::vector<double>{0.7e-9, 0.7e-9}));
  EXPECT_EQ(um.reference, (std::vector<double>{1e-7, 3e-7, 1.1e-6, -2.5e-6}));
  EXPECT_DOUBLE_EQ(inches.reference[3], -2.5 * 0.0254);
  EXPECT_DOUBLE_EQ(inches.volume[0], 0.7 * 0.0254 * 0.0254 * 0.0254);
  EXPECT_EQ(source_rows(file(), mm, 2, 1e-3), (std::vector<std::int32_t>{0, 1}));
  EXPECT_EQ(source_rows(file(), mm, 2), (std::vector<std::int32_t>{-1, -1}));
  static_cast<void>(read("x,y,volume\n0,0,1e-320\n"));
  EXPECT_THROW(static_cast<void>(in_unit(1e-3)), InputError);
}

const std::vector<double> three_places{0, 0, 1, 0, 2, 0};

TEST_F(PointFile, ReadsCommaSeparatedColumnsInAnyOrder) {
  const Points points = read(
      "# made by hand\n\n"
      "volume, y, x, set\n"
      "0.5, 0, 1, right|all\n"
      "# in between\n"
      "0.25, 0, 0, all | left side\n"
      "+0.75e0, 0.0, 2, \n");
  EXPECT_EQ(points.dimension, 2);
  EXPECT_EQ(points.reference, three_places);  // renumbered
  EXPECT_EQ(points.volume, (std::vector<double>{0.25, 0.5, 0.75}));
  ASSERT_EQ(points.sets.size(), 3u);
  EXPECT_EQ(points.sets.at("all"), (std::vector<Index>{0, 1}));
  EXPECT_EQ(points.sets.at("right"), (std::vector<Index>{1}));
  EXPECT_EQ(points.sets.at("left side"), (std::vector<Index>{0}));
}

TEST_F(PointFile, ReadsBlankSeparatedColumnsWithoutASet) {
  const Points points = read("x\ty   volume set\n  0 0 1 a|b\n1 0\t1\n2 0 1 b\n");
  EXPECT_EQ(points.reference, three_places);
  EXPECT_EQ(points.sets.at("a"), (std::vector<Index>{0}));
  EXPECT_EQ(points.sets.at("b"), (std::vector<Index>{0, 2}));
}

TEST_F(PointFile, ReadsFilesOfOtherSystems) {
  EXPECT_EQ(read("\xef\xbb\xbfx,y,volume\r\n0,0,1\r\n1,0,1\r\n2,0,1").reference, three_places);
}

TEST_F(PointFile, HasTheCoordinatesOfItsDimension) {
  EXPECT_EQ(read("x volume\n1 1\n", 1).reference, (std::vector<double>{1}));
  EXPECT_EQ(read("x y z volume\n1 2 3 1\n", 3).reference, (std::vector<double>{1, 2, 3}));
}

TEST_F(PointFile, TakesItsSpacingFromTheMeanVolume) {
  EXPECT_DOUBLE_EQ(read("x y volume\n0 0 0.02\n1 0 0.06\n", 2, 0.5).spacing, std::sqrt(0.08));
  EXPECT_DOUBLE_EQ(read("x y z volume\n0 0 0 8\n", 3).spacing, 2.0);
  EXPECT_DOUBLE_EQ(read("x volume\n0 8\n", 1, 2.0).spacing, 4.0);
}

TEST_F(PointFile, NamesTheLineOfABadColumnName) {
  EXPECT_EQ(refusal("# head\nx,volume\n0,1\n"),
            std::pair(2, std::string("column 'y' is missing; the columns are x, y, volume, and "
                                     "optionally set and columns of your own")));
  EXPECT_EQ(
      refusal("x,y,volumne\n0,0,1\n"),
      std::pair(1, std::string("column 'volume' is missing; the columns are x, y, volume, and "
                               "optionally set and columns of your own; did you mean it by "
                               "'volumne'?")));
  EXPECT_EQ(refusal("x,y,z,volume\n0,0,0,1\n").first, 1);
  EXPECT_EQ(refusal("x,y,x,volume\n0,0,0,1\n"),
            std::pair(1, std::string("column 'x' appears twice")));
}

TEST_F(PointFile, KeepsFurtherColumnsWithTheirPoints) {
  const Points points = read(
      "temperature, x, y, volume, set, v_x\n"
      "31.5, 1, 0, 1, a, -1\n"
      "+3e1, 0, 0, 1, , 0\n"
      "33, 2, 0, 1, b|a, 1e-300\n");
  EXPECT_EQ(points.reference, three_places);  // renumbered, and the columns with them
  ASSERT_EQ(points.columns.size(), 2u);
  EXPECT_EQ(points.columns.at("temperature"), (std::vector<double>{30, 31.5, 33}));
  EXPECT_EQ(points.columns.at("v_x"), (std::vector<double>{0, -1, 1e-300}));
  EXPECT_EQ(further_columns(file(), 2), (std::vector<std::string>{"temperature", "v_x"}));
  EXPECT_TRUE(read("x y volume set\n0 0 1\n").columns.empty());
}

TEST_F(PointFile, RefusesColumnsThatExpressionsCouldNotUse) {
  for (const char* name : {"t", "load", "spacing", "pi", "sin", "table", "a-b", "2nd", "", "z"}) {
    const auto [line, message] =
        refusal("# remark\nx,y,volume," + std::string(name) + "\n0,0,1,1\n");
    EXPECT_EQ(line, 2) << name;
    EXPECT_NE(message.find("'" + std::string(name) + "'"), std::string::npos) << message;
  }
  EXPECT_EQ(refusal("x,y,volume,T,T\n0,0,1,1,1\n"),
            std::pair(1, std::string("column 'T' appears twice")));
  EXPECT_EQ(refusal("x,y,volume,T\n0,0,1,1\n1,0,1,nan\n"),
            std::pair(3, std::string("T = 'nan' is not finite")));
  EXPECT_EQ(refusal("x,y,volume,T\n0,0,1,1\n1,0,1,\n"),
            std::pair(3, std::string("T = '' is not a number")));
  EXPECT_EQ(refusal("x,y,volume,T\n0,0,1,1e999\n").first, 2);
}

TEST_F(PointFile, TellsThatTheLineOfNamesIsARemark) {
  const auto [line, told] = refusal("# x y volume\n0 0 1\n");
  EXPECT_EQ(line, 2);
  EXPECT_NE(told.find("this one has numbers"), std::string::npos) << told;
  EXPECT_NE(told.find("remove the #"), std::string::npos) << told;
}

TEST_F(PointFile, RefusesNamesOfSetsThatResultsCanNotHave) {
  EXPECT_EQ(refusal("x,y,volume,set\n0,0,1,a|.\n").first, 2);
  EXPECT_EQ(refusal("x,y,volume,set\n0,0,1," + std::string(101, 'a') + "\n").first, 2);
  EXPECT_EQ(refusal("x,y,volume,set\n0,0,1,a.b\n").first, 0);
}

TEST_F(PointFile, KnowsWhichPointOfTheFileEachIs) {
  const std::vector<double> x{3, 1, 2, 0};
  std::string text = "# remark\nx,y,volume\n";
  for (const double at : x) text += std::to_string(at) + ",0,1\n";
  const Points points = read(text);
  const std::vector<std::int32_t> row = source_rows(file(), points, points.count());
  ASSERT_EQ(row.size(), x.size());
  for (Index i = 0; i < points.count(); ++i) {
    EXPECT_EQ(points.position(i)[0], x[std::size_t(row[std::size_t(i)])]);
  }
}

TEST_F(PointFile, NamesTheLineOfABadValue) {
  const std::string good = "x,y,volume\n0,0,1\n\n";
  const auto refused = [&](const std::string& line) { return refusal(good + line + "\n2,0,1\n"); };
  ASSERT_EQ(refused("1,0,1").first, 0);
  EXPECT_EQ(refused("1,one,1"), std::pair(4, std::string("y = 'one' is not a number")));
  EXPECT_EQ(refused("1,0.5m,1").first, 4);
  EXPECT_EQ(refused("1,,1").first, 4);
  EXPECT_EQ(refused("nan,0,1"), std::pair(4, std::string("x = 'nan' is not finite")));
  EXPECT_EQ(refused("1,-inf,1").first, 4);
  EXPECT_EQ(refused("1,0,inf").first, 4);
  EXPECT_EQ(refused("1e999,0,1"), std::pair(4, std::string("x = '1e999' is out of range")));
  EXPECT_EQ(refused("1,0,0"), std::pair(4, std::string("volume = 0 must be positive")));
  EXPECT_EQ(refused("1,0,-1").first, 4);
  EXPECT_EQ(refused("1,0"), std::pair(4, std::string("2 values for 3 columns")));
  EXPECT_EQ(refused("1,0,1,7").first, 4);
}

TEST_F(PointFile, NamesTheLinesOfTwoPointsAtOnePlace) {
  const std::string message = "the point at (0.1, 2) has the same position as the point in line 2";
  EXPECT_EQ(refusal("x y volume\n0.1 2 1\n1 2 1\n\n0.1 2 1\n"), std::pair(5, message));
  // Closer than 1e-9 of the spacing, which is 1, also where a coarse cell ends (at zero).
  EXPECT_EQ(refusal("x y volume\n-4e-10 3e-10 1\n4e-10 -3e-10 1\n").first, 3);
  EXPECT_EQ(refusal("x y z volume\n2e-9 -4e-10 0 1\n2.1e-9 4e-10 -1e-10 1\n", 3).first, 3);
  EXPECT_EQ(refusal("x y volume\n0 0 1\n2e-9 0 1\n").first, 0);
}

TEST_F(PointFile, FindsOnePairInALatticeOfManyPoints) {
  std::string text = "x y z volume\n";
  for (int k = 0; k < 20 * 20 * 20; ++k) {
    text += std::to_string(k % 20) + " " + std::to_string(k / 20 % 20) + " " +
            std::to_string(k / 400) + " 1\n";
  }
  EXPECT_EQ(refusal(text, 3).first, 0);
  EXPECT_EQ(refusal(text + "7 8 9.0000000005 1\n", 3).first, 8002);
}

TEST_F(PointFile, RefusesAFileWithoutPoints) {
  for (const char* text : {"", "# nothing\n", "x,y,volume\n"}) {
    EXPECT_NE(refusal(text).second.find("file = " + file().string()), std::string::npos);
  }
  EXPECT_THROW((void)read_points(folder_ / "missing.csv", 2, 1.0), InputError);
  EXPECT_THROW((void)read_points(folder_, 2, 1.0), InputError);
}

TEST_F(PointFile, NeedsAPositiveCrossSection) {
  for (const double cross_section : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW((void)read("x volume\n0 1\n", 1, cross_section), InputError);
  }
}

}  // namespace
}  // namespace peristat
