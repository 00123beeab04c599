#include "src/core/linear_table.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/core/table_calls.hpp"

namespace peristat {
namespace {

class LinearTables : public ::testing::Test {
 protected:
  LinearTables() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("peristat linear table " + std::to_string(getpid()) + "_" + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~LinearTables() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& text) const { std::ofstream(file(), std::ios::binary) << text; }
  LinearTable read(const std::string& text, const std::string& column = "") const {
    write(text);
    return {file(), column};
  }

  /// What follows the file's name in the message that refuses a text.
  std::string refusal(const std::string& text, const std::string& column = "") const {
    try {
      (void)read(text, column);
    } catch (const InputError& error) {
      const std::string message = error.what(), before = file().string();
      return message.substr(message.find(before) + before.size());
    }
    return "accepted";
  }

  Expression expression(const std::string& arguments, int dimension = 1) const {
    return {"2*table(\"" + file().string() + "\", " + arguments + ")", dimension, 1.0, {"load"}};
  }

  std::filesystem::path file() const { return folder_ / "a (1).csv"; }
  std::filesystem::path folder_;
};

TEST_F(LinearTables, AreLinearFromRowToRow) {
  for (const char* text :
       {"# made by hand\n\nt, u\n0, 1\n2,3\n# in between\n2.5 , -1e0\n", "0 1\n2 3\n2.5 -1\n",
        "\xef\xbb\xbftime,\"u\"\r\n0,1\r\n2,3\r\n2.5,-1"}) {
    const LinearTable table = read(text);
    EXPECT_EQ(table.first(), 0.0);
    EXPECT_EQ(table.last(), 2.5);
    for (const auto& [at, value] :
         {std::array{0.0, 1.0}, {1.0, 2.0}, {2.0, 3.0}, {2.25, 1.0}, {2.5, -1.0}}) {
      EXPECT_EQ(table(at), value) << at;  // at rows to the last bit
    }
  }
  const LinearTable other = read("x a b\n0 1 5\n1 2 7\n", "b");
  EXPECT_EQ(other(0.5), 6.0);
}

TEST_F(LinearTables, CoverTheirRangeUpToRoundOff) {
  const LinearTable table = read("1 0\n3 1\n");
  EXPECT_TRUE(table.covers(1.0) && table.covers(3.0) && table.covers(3.0 + 1e-10));
  EXPECT_FALSE(table.covers(3.0 + 1e-7) || table.covers(0.999) || table.covers(std::nan("")));
  EXPECT_TRUE(std::isnan(table(std::nan(""))));
}

TEST_F(LinearTables, NameTheLineOfWhatIsWrong) {
  EXPECT_EQ(refusal("t,u\n0,1\n0,2\n"), ":3: the first column must ascend, but 0 follows 0");
  EXPECT_EQ(refusal("0 1\n2 1\n1 1\n"), ":3: the first column must ascend, but 1 follows 2");
  EXPECT_EQ(refusal("0 1\n2 nan\n"), ":2: 'nan' is not finite");
  EXPECT_EQ(refusal("0 1\n2 1e999\n"), ":2: '1e999' is out of range");
  EXPECT_EQ(refusal("0,1\n2,one\n"), ":2: 'one' is not a number");
  EXPECT_EQ(refusal("nan,1\n2,3\n"), ":1: 'nan' is not finite");
  EXPECT_EQ(refusal("0,1\n2\n"), ":2: 1 values for 2 columns");
  EXPECT_EQ(refusal("0;1\n2;3\n"), ":1: a table needs two columns, separated by commas or blanks");
  EXPECT_NE(refusal("0 1 2\n2 3 4\n").find("has 3 columns: name the one"), std::string::npos);
  EXPECT_EQ(refusal("x a bee\n0 1 2\n2 3 4\n", "be"),
            ":1: no column 'be' of values; there are a, bee; did you mean bee?");
  EXPECT_EQ(refusal("x a\n0 1\n2 3\n", "x"), ":1: no column 'x' of values; there are a");
  EXPECT_EQ(refusal("x a a\n0 1 2\n2 3 4\n", "a"), ":1: column 'a' appears twice");
  EXPECT_NE(refusal("0 1\n2 3\n", "a").find("no line names the columns"), std::string::npos);
  for (const char* text : {"", "# nothing\n", "t,u\n", "t,u\n0,1\n"}) {
    EXPECT_EQ(refusal(text), ": a table needs at least two rows") << text;
  }
  EXPECT_THROW(LinearTable(folder_ / "missing.csv", ""), InputError);
  EXPECT_THROW(LinearTable(folder_, ""), InputError);
}

TEST_F(LinearTables, StandInExpressions) {
  write("t u v\n0 1 0\n2 3 4\n");
  const Expression of_load = expression("'u', load^2 + 0*max(x, 1)");
  EXPECT_EQ(of_load({}, std::array{1.0}), 4.0);
  EXPECT_TRUE(of_load.has_parameters());
  EXPECT_FALSE(of_load.is_constant());
  EXPECT_TRUE(expression("\"v\", 0.5").is_constant());
  EXPECT_EQ(expression("\"v\", 0.5")({}), 2.0);
  const std::string name = "table('" + file().string() + "', 'v', ";
  const Expression nested(name + "x)*(x < 1) + x*" + name + "1)", 1, 1.0);
  EXPECT_EQ(nested({0.5, 0, 0}), 2.0);
  EXPECT_EQ(nested({2.0, 0, 0}), 4.0);
}

TEST_F(LinearTables, AreNotLeftInSilence) {
  (void)read("0 1\n2 3\n");
  const Expression of_load = expression("load");
  EXPECT_EQ(of_load({}, std::array{2.0 + 1e-11}), 6.0);
  try {
    (void)of_load({0.25, 0, 0}, std::array{2.5});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.allowed(),
              "the table " + file().string() +
                  " goes from 0 to 2, but its value at 2.5 is needed at (x) = "
                  "(0.25), load = 2.5; add a row, or hold its ends with min and max");
  }
  EXPECT_THROW(expression("3"), InputError);  // at once
  // Also a constant that the parser could fold into the rest.
  EXPECT_THROW((void)expression("3 + 0*x")({}), InputError);
  EXPECT_THROW((void)Expression("x + table('" + file().string() + "', 9)", 1, 1.0)({}), InputError);
  EXPECT_EQ(expression("min(max(load, 0), 2)")({}, std::array{7.0}), 6.0);
  EXPECT_EQ(expression("load > 2 ? 1 : load")({}, std::array{7.0}), 4.0);
  EXPECT_THROW((void)expression("sqrt(-1 - load)")({}, std::array{1.0}), InputError);
}

TEST_F(LinearTables, RefuseCallsThatAreNone) {
  (void)read("0 1\n2 3\n");
  const std::string name = "'" + file().string() + "'";
  for (const std::string& text : std::vector<std::string>{
           "table(0, x)", "table(" + name + ")", "table(" + name + ", x, 1)", "table",
           "table " + name, "table(" + name.substr(0, 5) + ", x)", "table('', x)", name,
           "x + " + name, "table(" + name + ", '', x)", "table(" + name + ", 'a', 'b', x)",
           "tables(" + name + ", x)", "table(" + name + ", 'u)", "table('missing.csv', x)",
           "max(" + name + ", x)"}) {
    EXPECT_THROW((void)Expression(text, 1, 1.0)({}), InputError) << text;
  }
  EXPECT_EQ(Expression("table(\t" + name + " , x )", 1, 1.0)({1, 0, 0}), 2.0);
}

TEST_F(LinearTables, GetOtherNames) {
  const auto longer = [](const std::string& file) { return "/tmp/it's/" + file; };
  EXPECT_EQ(with_table_files("2*table('a.csv', x) + table( 'b.csv' , \"c\", table(\"a.csv\", y))",
                             longer),
            "2*table(\"/tmp/it's/a.csv\", x) + table( \"/tmp/it's/b.csv\", \"c\", "
            "table(\"/tmp/it's/a.csv\", y))");
  EXPECT_EQ(with_table_files("x + tablecloth", longer), "x + tablecloth");
  EXPECT_THROW((void)with_table_files("table('a\"b', x)", longer), InputError);
}

}  // namespace
}  // namespace peristat
