#include "src/core/expression.hpp"

#include <array>
#include <cmath>
#include <locale>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

const std::vector<std::string> with_load{"load"};
const std::vector<std::string> without_load;

double value(const std::string& text, const Coordinates& place = {}, double load_factor = 0.0) {
  return Expression(text, 3, 0.01, with_load)(place, std::array{load_factor});
}

/// What is said about a text that is refused, when it is read or when it is evaluated.
std::string refusal(const std::string& text, int dimension = 2,
                    const std::vector<std::string>& load = with_load,
                    const Coordinates& place = {}) {
  try {
    (void)Expression(text, dimension, 0.01, load)(place, std::array{0.5});
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "");
    EXPECT_EQ(error.value(), '"' + text + '"');
    return error.allowed();
  }
  return "accepted";
}

TEST(Expression, KnowsPlaceLoadFactorAndConstants) {
  EXPECT_EQ(value("x + 10*y + 100*z + 1000*load", {1, 2, 3}, 4), 4321);
  EXPECT_EQ(value("pi"), std::numbers::pi);
  EXPECT_EQ(value("3*spacing"), 3 * 0.01);
}

TEST(Expression, FollowsPlaceAndLoadFactorFromCallToCall) {
  const Expression expression("x*load", 1, 1.0, with_load);
  EXPECT_EQ(expression({2, 0, 0}, std::array{3.0}), 6);
  EXPECT_EQ(expression({5, 0, 0}, std::array{7.0}), 35);
  EXPECT_EQ(expression({5, 0, 0}, std::array{0.0}), 0);
}

TEST(Expression, KnowsParametersByTheirNames) {
  const Expression expression("load - 2*load2", 0, 0.0, {"load", "load2"});
  EXPECT_EQ(expression({}, std::array{3.0, 1.0}), 1);
  EXPECT_EQ(
      refusal("load2", 1, with_load),
      "unknown variable load2; allowed are x, load, pi, spacing, spacing_x; did you mean load?");
}

TEST(Expression, HasNoSpacingWhereThereIsNone) {
  EXPECT_THROW(Expression("spacing", 0, 0.0, {"step"}), InputError);
}

TEST(Expression, HasTheUsualOperatorsAndFunctions) {
  EXPECT_EQ(value("-x^2", {3, 0, 0}), -9);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("2^-1"), 0.5);
  EXPECT_EQ(value("6/2*3 - 4 - 1"), 4);
  EXPECT_EQ(value("min(3, max(1, 2)) + abs(-4)"), 6);
  EXPECT_EQ(value("atan2(1, 0)"), std::numbers::pi / 2);
  EXPECT_EQ(value("log(10)"), std::log(10.0));  // natural
  EXPECT_EQ(value("1.5e-3 + .5 + 2."), 1.5e-3 + 0.5 + 2.0);
}

TEST(Expression, ComparesAndCombinesTruthValues) {
  EXPECT_EQ(value("x > 0 && x < 1", {0.5, 0, 0}), 1);
  EXPECT_EQ(value("x > 0 && x < 1", {1.5, 0, 0}), 0);
  EXPECT_EQ(value("x < 0 || x >= 1", {1, 0, 0}), 1);
  EXPECT_EQ(value("x == 0.1", {0.1, 0, 0}), 1);
  EXPECT_EQ(value("x != 0.1", {0.1, 0, 0}), 0);
  EXPECT_EQ(value("(x < 1) == (y < 1)", {2, 2, 0}), 1);
  EXPECT_EQ(value("x > 1 ? x > 3 ? 10 : 20 : 30", {2, 0, 0}), 20);
  EXPECT_EQ(value("x > 1 ? x > 3 ? 10 : 20 : 30", {0, 0, 0}), 30);
}

TEST(Expression, AgreesWithCompiledArithmeticWhereTheParserOptimises) {
  const Coordinates at{1.3, -0.7, 2.1};
  const auto [x, y, z] = at;
  const auto near = [](double expected) { return 4e-16 * (1.0 + std::abs(expected)); };
  const std::vector<std::pair<std::string, double>> forms{
      {"2*x + 3*x - x*4", x},
      {"x^2 + x^3 + x^4", x * x + x * x * x + x * x * x * x},
      {"(x + 2)*3 - 1", (x + 2) * 3 - 1},
      {"5 - 2*x - 1", 5 - 2 * x - 1},
      {"x/4/y + y*2*z", x / 4 / y + y * 2 * z},
      {"x - (y - (z - 1))", x - (y - (z - 1))}};
  for (const auto& [text, expected] : forms) {
    EXPECT_NEAR(value(text, at), expected, 8 * near(expected)) << text;  // some round-offs
  }
}

TEST(Expression, MayRunOverLines) { EXPECT_EQ(value("1\n+\t2\r\n"), 3); }

TEST(Expression, IsConstantWithoutAVariable) {
  EXPECT_TRUE(Expression("2*pi*spacing", 2, 0.01, with_load).is_constant());
  EXPECT_TRUE(Expression(2.75e-4).is_constant());
  EXPECT_EQ(Expression(2.75e-4)({1, 2, 3}, std::array{4.0}), 2.75e-4);
  EXPECT_EQ(Expression(2.75e-4).text(), "0.000275");
  EXPECT_FALSE(Expression("0*load", 2, 0.01, with_load).is_constant());
  EXPECT_FALSE(Expression("max(1, x)", 2, 0.01, with_load).is_constant());
}

TEST(Expression, KnowsWhetherAParameterOccurs) {
  EXPECT_TRUE(Expression("x*load", 2, 0.01, with_load).has_parameters());
  EXPECT_FALSE(Expression("x + spacing", 2, 0.01, with_load).has_parameters());
  EXPECT_FALSE(Expression("2", 2, 0.01, with_load).has_parameters());
  EXPECT_FALSE(Expression(2.75e-4).has_parameters());
}

const Columns columns{{"temperature", {20.0, 30.0}}, {"v_1", {0.5, -0.5}}};

TEST(Expression, HasTheColumnsOfAPoint) {
  const Expression expression("temperature*load + v_1 + x", 2, 0.01, with_load, columns);
  EXPECT_FALSE(expression.is_constant());
  EXPECT_TRUE(expression.has_parameters());
  EXPECT_EQ(expression({1, 0, 0}, std::array{2.0}, 0), 41.5);
  EXPECT_EQ(expression({1, 0, 0}, std::array{2.0}, 1), 60.5);
  EXPECT_EQ(expression({1, 0, 0}, std::array{2.0}, 0), 41.5);
  EXPECT_FALSE(Expression("temperature", 2, 0.01, with_load, columns).has_parameters());
  // A place is enough where no column occurs.
  EXPECT_EQ(Expression("x", 2, 0.01, {}, columns)({3, 0, 0}), 3);
}

TEST(Expression, RefusesAColumnWhereThereIsNoPoint) {
  const Expression expression("2*temperature", 2, 0.01, {}, columns);
  for (const Index point : {Expression::no_point, Index(2), Index(-7)}) {
    try {
      (void)expression({1, 2, 0}, {}, point);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_EQ(error.allowed(),
                "column temperature has a value at each point, but the value at (x, y) = (1, 2) is "
                "needed, where there is none");
    }
  }
  // Names without values, with which a case file is checked.
  const Columns names{{"temperature", {}}};
  EXPECT_THROW((void)Expression("temperature", 2, 0.01, {}, names)({}, {}, 0), InputError);
}

TEST(Expression, NamesTheColumnsThatAreAllowed) {
  const auto refused = [](const std::string& text, int dimension) {
    try {
      (void)Expression(text, dimension, 0.01, with_load, columns);
    } catch (const InputError& error) {
      return error.allowed();
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refused("temprature", 1),
            "unknown variable temprature; allowed are x, load, pi, spacing, spacing_x, "
            "temperature, v_1; did you mean temperature?");
  EXPECT_EQ(
      refused("2*temperature", 0),
      "column temperature has a value at each point, but this number does not belong to a point");
}

TEST(Expression, KnowsWhichNamesColumnsCanHave) {
  for (const char* name : {"temperature", "_a", "E1", "velocity_x", "step", "volume"}) {
    EXPECT_EQ(why_no_column(name), "") << name;
  }
  for (const char* name :
       {"x",       "y",         "z",       "t",    "load",  "load4", "pi",
        "spacing", "spacing_y", "horizon", "free", "table", "sin",   "sqrt",
        "sum",     "",          "1st",     "a b",  "a-b",   "T(K)",  "\xc3\xa9"}) {
    EXPECT_NE(why_no_column(name), "") << name;
  }
  EXPECT_NE(why_no_column(std::string(101, 'a')), "");
}

TEST(Expression, CanBeMoved) {
  Expression first("x + load", 1, 1.0, with_load);
  const Expression second = std::move(first);
  EXPECT_EQ(second({1, 0, 0}, std::array{2.0}), 3);
}

struct CommaAsDecimalPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(Expression, ReadsAPointWhateverTheLocale) {
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new CommaAsDecimalPoint));
  const double read = value("1.5 + x", {1, 0, 0});
  const std::string text = Expression(1.5).text();
  std::locale::global(before);
  EXPECT_EQ(read, 2.5);
  EXPECT_EQ(text, "1.5");
}

TEST(Expression, NamesAnUnknownVariableTheAllowedAndTheNearest) {
  EXPECT_EQ(refusal("2*laod"),
            "unknown variable laod; allowed are x, y, load, pi, spacing, spacing_x, spacing_y; did "
            "you mean load?");
  EXPECT_EQ(refusal("z", 2),
            "unknown variable z; allowed are x, y, load, pi, spacing, spacing_x, spacing_y");
  EXPECT_EQ(refusal("load*x", 1, without_load),
            "unknown variable load; allowed are x, pi, spacing, spacing_x");
  EXPECT_NE(refusal("sqr(x)").find("unknown function sqr; allowed are abs, "), std::string::npos);
  EXPECT_NE(refusal("sqr(x)").find("did you mean sqrt?"), std::string::npos);
  EXPECT_NE(refusal("x and y").find("unknown variable and"), std::string::npos);
  EXPECT_NE(refusal("_pi").find("did you mean pi?"), std::string::npos);
}

TEST(Expression, RefusesWhatTheParserWouldTakeInSilence) {
  EXPECT_NE(refusal("x = 1").find("character 3 assigns"), std::string::npos);
  EXPECT_NE(refusal("0 < x < 1").find("character 7"), std::string::npos);
  EXPECT_NE(refusal("1, 5").find("one value"), std::string::npos);
  EXPECT_NE(refusal("max(1, 2), x").find("one value"), std::string::npos);
  EXPECT_NE(refusal(std::string("x\0y", 3)).find("zero character"), std::string::npos);
  EXPECT_EQ(refusal("max(0 < x, x < 1)"), "accepted");
  EXPECT_EQ(refusal("0 < x && x < 1 ? x > 2 : y > 2"), "accepted");
}

TEST(Expression, RefusesTextThatIsNoExpression) {
  for (const char* text :
       {"x >",      "(x", "x)",       "2x",    "x y",   "1..2",   "-",    "min()",
        "atan2(1)", "!x", "sin",      "\"x\"", "x ? 1", "1e400",  "0x10", "x & y",
        "()",       ",",  "\xc3\xa9", "x(1)",  "1e",    "x ** 2", "@"}) {
    EXPECT_NE(refusal(text), "accepted") << text;
  }
  EXPECT_NE(refusal("x + * y").find("character"), std::string::npos);
  EXPECT_EQ(refusal("x + * y").find("position"), std::string::npos) << refusal("x + * y");
  EXPECT_NE(refusal("load ** 2").find("character 6 is not an operator; write a power with ^"),
            std::string::npos);
  const std::string longest = std::string(19'998, ' ') + "1";
  EXPECT_EQ(refusal(longest), "accepted");
  EXPECT_EQ(refusal(longest + "1"),
            "an expression may have at most 19999 characters; this one has 20000. Many values are "
            "better kept in a file, as in table(\"file.csv\", x)");
  for (const char* text : {"", " ", "\n"}) {
    EXPECT_THROW(Expression(text, 2, 0.01, with_load), InputError);
  }
}

TEST(Expression, NamesThePlaceWhereItIsNotFinite) {
  EXPECT_EQ(refusal("1/x", 2, with_load, {0, 2, 0}),
            "the value at (x, y) = (0, 2), load = 0.5 is inf; it must be finite");
  EXPECT_NE(refusal("sqrt(x - 1)", 1, without_load).find("at (x) = (0) is"), std::string::npos);
  EXPECT_EQ(refusal("1/x", 2, with_load, {4, 0, 0}), "accepted");
  // Without a dimension there is no place, only the load factor.
  EXPECT_EQ(refusal("1/(load - 0.5)", 0), "the value at load = 0.5 is inf; it must be finite");
}

TEST(Expression, RefusesAConstantThatIsNotFiniteAtOnce) {
  EXPECT_THROW(Expression("1/0", 2, 0.01, with_load), InputError);
  EXPECT_THROW(Expression("log(-pi)", 2, 0.01, with_load), InputError);
  EXPECT_THROW(Expression(std::nan("")), InputError);
}

}  // namespace
}  // namespace peristat
