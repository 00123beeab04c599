#include "cases/runner/input/quantity.hpp"

#include <cmath>
#include <locale>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/input/case_keys.hpp"
#include "cases/runner/input/expression_dimension.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// Size of a unit in SI units; 0 if the text is no unit.
double size_of(const std::string& text) {
  std::string why_not;
  const auto unit = parse_unit(text, why_not);
  EXPECT_EQ(why_not.empty(), unit.has_value()) << text << why_not;
  return unit ? unit->size() : 0.0;
}

std::string reason(const std::string& text) {
  std::string why_not;
  EXPECT_FALSE(parse_unit(text, why_not)) << text;
  return why_not;
}

TEST(UnitParser, KnowsEveryPrefixOfEverySymbolThatTakesOne) {
  const std::map<std::string, double> prefixes{{"", 1.0},   {"n", 1e-9}, {"u", 1e-6}, {"µ", 1e-6},
                                               {"μ", 1e-6}, {"m", 1e-3}, {"c", 1e-2}, {"d", 1e-1},
                                               {"k", 1e3},  {"M", 1e6},  {"G", 1e9},  {"T", 1e12}};
  for (const auto& [symbol, size] : std::map<std::string, double>{{"m", 1.0},
                                                                  {"g", 1e-3},
                                                                  {"s", 1.0},
                                                                  {"N", 1.0},
                                                                  {"Pa", 1.0},
                                                                  {"J", 1.0},
                                                                  {"K", 1.0},
                                                                  {"Hz", 1.0},
                                                                  {"rad", 1.0}}) {
    for (const auto& [prefix, factor] : prefixes)
      EXPECT_DOUBLE_EQ(size_of(prefix + symbol), factor * size) << prefix << symbol;
  }
}

TEST(UnitParser, KnowsUnitsWithoutPrefixes) {
  const std::map<std::string, double> sizes{{"t", 1e3},
                                            {"min", 60.0},
                                            {"h", 3600.0},
                                            {"bar", 1e5},
                                            {"%", 1e-2},
                                            {"in", 0.0254},
                                            {"ft", 0.3048},
                                            {"lbf", 4.4482216152605},
                                            {"psi", 6894.757293168361},
                                            {"ksi", 6894757.293168361},
                                            {"deg", std::numbers::pi / 180},
                                            {"°", std::numbers::pi / 180}};
  for (const auto& [symbol, size] : sizes) EXPECT_DOUBLE_EQ(size_of(symbol), size) << symbol;
  EXPECT_EQ(size_of("kt"), 0.0);
  EXPECT_EQ(size_of("kmin"), 0.0);
}

TEST(UnitParser, MultipliesDividesAndRaises) {
  const std::map<std::string, double> sizes{{"kg/m3", 1.0},
                                            {"kg/dm3", 1e3},
                                            {"t/mm^3", 1e12},
                                            {"N/mm^2", 1e6},
                                            {"N/mm²", 1e6},
                                            {"N*mm", 1e-3},
                                            {"N·mm", 1e-3},
                                            {"1/K", 1.0},
                                            {"K^-1", 1.0},
                                            {"1/ms", 1e3},
                                            {"mm/ms^2", 1e3},
                                            {"kN/(mm*s)", 1e6},
                                            {"MPa*sqrt(m)", 1e6},
                                            {"MPa sqrt(m)", 1e6},
                                            {"MPa√m", 1e6},
                                            {"MPa*m^0.5", 1e6},
                                            {"MPa*m^(1/2)", 1e6},
                                            {"MPa*√(m)", 1e6},
                                            {"g/cm³", 1e3},
                                            {"J/m2/s", 1.0},
                                            {"1/(m*s)", 1.0},
                                            {"N/mm^1.5", 31622.776601683795},
                                            {"MPa*sqrt(mm)", 31622.776601683795}};
  for (const auto& [text, size] : sizes) EXPECT_DOUBLE_EQ(size_of(text), size) << text;
  EXPECT_EQ(unit_of_key("N/mm^1.5").dimension, unit_of_key("Pa*sqrt(m)").dimension);
  EXPECT_EQ(unit_of_key("J/m2").dimension, unit_of_key("N/m").dimension);
}

TEST(UnitParser, RefusesWhatIsNoUnit) {
  EXPECT_EQ(reason("furlongs"), "there is no unit \"furlongs\"");
  EXPECT_EQ(reason("mpa"), "there is no unit \"mpa\"; did you mean mPa or MPa?");
  EXPECT_EQ(reason("KN"), "there is no unit \"KN\"; did you mean kN?");
  for (const char* text : {"",
                           "m m",
                           "mm * load",
                           "m^",
                           "m^-",
                           "/m",
                           "m/",
                           "m**2",
                           "m^1.25",
                           "m^(1/3)",
                           "sqrt(m",
                           "sqrt(m)^0.5",
                           "sqrt(sqrt(m))",
                           "((((m^99)^99)^99)^99)",
                           "(((%^99)^99)^99)^99",
                           "((((((m",
                           "1",
                           "5",
                           "m+s",
                           "m^100",
                           "1/",
                           "(",
                           ")",
                           "√"})
    EXPECT_FALSE(reason(text).empty()) << text;
  EXPECT_FALSE(reason(std::string(100'000, '(')).empty());
}

TEST(LengthOfNumber, IsThatOfADecimalInFront) {
  const std::vector<std::pair<std::string, std::size_t>> lengths{
      {"2.5 mm", 3}, {"210GPa", 3}, {"-1e-3m", 5}, {"+.5", 3},    {"5.m", 2},    {"1e400 m", 5},
      {"1 e5", 1},   {"5e", 1},     {"0x10 m", 1}, {"nan m", 0},  {"inf", 0},    {"mm", 0},
      {"", 0},       {"-", 0},      {".", 0},      {"-inf m", 0}, {"2,5 mm", 1}, {"1_000 m", 1}};
  for (const auto& [text, length] : lengths) EXPECT_EQ(length_of_number(text), length) << text;
}

TEST(InUnit, RoundsOnceWhereTheUnitIsAPowerOfTen) {
  EXPECT_EQ(in_unit("2.5", unit_of_key("mm")), 0.0025);
  EXPECT_EQ(in_unit("210", unit_of_key("GPa")), 210e9);
  EXPECT_EQ(in_unit("2.4", unit_of_key("kg/dm3")), 2400.0);
  EXPECT_EQ(in_unit("2.4e-9", unit_of_key("t/mm^3")), 2400.0);
  EXPECT_EQ(in_unit("30", unit_of_key("MPa*sqrt(m)")), 30e6);
  EXPECT_EQ(in_unit("0.3", unit_of_key("N/mm")), 300.0);
  EXPECT_EQ(in_unit("2.5", unit_of_key("in")), 0.0635);
  EXPECT_EQ(in_unit("90", unit_of_key("deg")), std::numbers::pi / 2);
  EXPECT_EQ(in_unit("30", unit_of_key("deg") / unit_of_key("degrees")), 30.0);
  EXPECT_FALSE(in_unit("1e400", unit_of_key("m")));
  EXPECT_FALSE(in_unit("1e308", unit_of_key("km")));
  EXPECT_FALSE(in_unit("1e308", unit_of_key("ksi")));
}

TEST(InUnit, DoesNotDependOnTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  EXPECT_EQ(in_unit("2.5", unit_of_key("mm")), 0.0025);
  EXPECT_EQ(in_unit("2.5", unit_of_key("in")), 0.0635);
  std::locale::global(before);
}

/// Name of the dimension of an expression, or the reason why its units do not fit.
std::string dimension_of(const std::string& text) {
  try {
    const auto dimension = dimension_of_expression(tokens_of(text));
    return dimension ? name_of(*dimension) : "any";
  } catch (const InputError& error) {
    return error.allowed();
  }
}

TEST(DimensionOfExpression, FollowsFromItsUnitsAndVariables) {
  for (const char* length :
       {"0.1 mm * load", "0.1mm*load*(1 + 0.5*sin(2*pi*t/(1 ms)))", "5 mm - x", "sqrt(4 mm2)",
        "max(0, 1 mm, y)", "-(2 mm)", "1 MPa / (200 GPa) * x", "x > 0 ? 1 mm : 0",
        "1 mm * table(\"f.csv\", t)", "1 mm/s*t", "1 mm * temperature", "1 mm*sin(30 deg)"})
    EXPECT_EQ(dimension_of(length), "a length") << length;
  EXPECT_EQ(dimension_of("5 MPa*y/(20 mm)"), "a stress");
  EXPECT_EQ(dimension_of("9.81 m/s^2*2.4 t/m3*y"), "a stress");
  EXPECT_EQ(dimension_of("abs(y) < 1 mm && x > 0"), "a number without a unit");
  EXPECT_EQ(dimension_of("(2 mm)^2"), "an area");
  EXPECT_EQ(dimension_of("0"), "any");
  EXPECT_EQ(dimension_of("0*x"), "any");
}

TEST(DimensionOfExpression, RefusesWhatIsNoExpression) {
  for (const char* broken : {"(", "1 mm +", "1 mm)", "", "1 mm 2", "sin", "2^", "x ? 1", "\"",
                             "(((((((1 m)^20)^20)^20)^20)^20)^20)^20"})
    EXPECT_NE(dimension_of(broken), "any") << broken;
  for (const char* part : {"(", "2^", "1 ? 2 : "}) {
    std::string deep;
    for (int k = 0; k < 50'000; ++k) deep += part;
    EXPECT_NE(dimension_of(deep + "1").find("nested too deeply"), std::string::npos) << part;
  }
}

TEST(DimensionOfExpression, RefusesUnitsThatDoNotFit) {
  const std::vector<std::pair<std::string, std::string>> reasons{
      {"1 mm + 5 MPa", "adds or compares a length and a stress"},
      {"y > 10 mm + 0.001", "adds or compares a length and a number without a unit"},
      {"x*y > 10 mm", "adds or compares an area and a length"},
      {"1 mm * sin(t)", "the argument of sin must have no unit; this one is a time"},
      {"2^(1 mm)", "an exponent must have no unit"},
      {"(1 mm)^load", "needs a whole number as exponent"},
      {"5 furlongs", "there is no unit \"furlongs\""},
      {"2 x", "write a product with *"}};
  for (const auto& [text, reason] : reasons)
    EXPECT_NE(dimension_of(text).find(reason), std::string::npos)
        << text << ": " << dimension_of(text);
}

/// Keys whose unit counts something; every other unit must be one that is converted.
TEST(UnitsOfKeys, AreUnitsOfMeasureOrCounts) {
  const std::vector<std::string> counts{"spacings", "bonds", "steps", "time steps", "blocks"};
  int measures = 0;
  for (const TableDescription& table : table_descriptions()) {
    for (const KeyDescription& key : table.keys) {
      const bool is_count = std::find(counts.begin(), counts.end(), key.unit) != counts.end();
      if (!key.unit.empty() && !is_count) {
        EXPECT_TRUE(is_unit_of_measure(key.unit)) << table.name << "." << key.name;
        EXPECT_NE(key.form, ValueForm::other) << table.name << "." << key.name;
        ++measures;
      }
      const bool has_expressions = key.allowed.find("xpression") != std::string::npos;
      EXPECT_EQ(key.form == ValueForm::expression, has_expressions)
          << table.name << "." << key.name;
    }
  }
  EXPECT_GT(measures, 50);
}

}  // namespace
}  // namespace peristat
