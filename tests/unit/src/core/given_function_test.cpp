#include "src/core/given_function.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

const std::vector<std::string> load{"load"};
const Columns no_columns;

/// f(a, b) = a + 10 b and g(a) = a^2, which count their calls and values.
class Counted {
 public:
  int calls = 0, values = 0;
  GivenFunctions functions{
      {"f", {2, counted([](auto at, std::size_t k) { return at(0, k) + 10.0 * at(1, k); })}},
      {"g", {1, counted([](auto at, std::size_t k) { return at(0, k) * at(0, k); })}}};

  [[nodiscard]] Expression expression(const std::string& text, int dimension = 2) const {
    return {text, dimension, 0.01, load, no_columns, functions};
  }
  [[nodiscard]] std::string refusal(const std::string& text) const {
    try {
      (void)expression(text);
    } catch (const InputError& error) {
      EXPECT_EQ(error.value(), '"' + text + '"');
      return error.allowed();
    }
    return "accepted";
  }

 private:
  template <class Value>
  std::function<void(std::span<const std::span<const double>>, std::span<double>)> counted(
      const Value& value) {
    return
        [this, value](std::span<const std::span<const double>> arguments, std::span<double> found) {
          ++calls;
          values += int(found.size());
          for (const std::span<const double> argument : arguments) {
            ASSERT_TRUE(argument.size() == found.size() || argument.size() == 1);
          }
          const auto at = [&](std::size_t argument, std::size_t k) {
            const std::span<const double> numbers = arguments[argument];
            return numbers[numbers.size() == 1 ? 0 : k];
          };
          for (std::size_t k = 0; k < found.size(); ++k) found[k] = value(at, k);
        };
  }
};

const std::vector<Coordinates> places{{1, 2, 0}, {3, 4, 0}, {5, 6, 0}};

TEST(GivenFunction, IsCalledInAnyExpression) {
  const Counted counted;
  const std::array<double, 1> loads{7.0};
  for (const auto& [text, wanted] : std::vector<std::pair<std::string, double>>{
           {"f(x, load)", 73},
           {"2*f(x + 1, load*y) - g(y)", 2 * (4 + 10 * 28) - 16},
           {"f(g(x), f(y, 1))", 9 + 10 * 14},
           {"x > 2 ? g( min(x, load) ) : 0", 9},
           {"g(2)", 4}}) {
    EXPECT_EQ(counted.expression(text)({3, 4, 0}, loads), wanted) << text;
  }
}

TEST(GivenFunction, IsCalledOnceForManyPlaces) {
  Counted counted;
  const Expression expression = counted.expression("1 + f(x*1000, load)/2");
  EXPECT_EQ(counted.calls, 0) << "not before it is needed";
  const std::vector<double> values = expression.at(places, std::array{0.5});
  EXPECT_EQ(counted.calls, 1);
  EXPECT_EQ(counted.values, 3);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_EQ(values[k], expression(places[k], std::array{0.5}));
    EXPECT_EQ(values[k], 1 + (places[k][0] * 1000 + 5) / 2);
  }
}

TEST(GivenFunction, OfTheLoadAloneFindsOneValue) {
  Counted counted;
  const std::vector<double> values = counted.expression("x + g(load)").at(places, std::array{3.0});
  EXPECT_EQ(counted.values, 1);
  EXPECT_EQ(values, (std::vector<double>{10, 12, 14}));
  EXPECT_EQ(counted.expression("g(load)").at(places, std::array{2.0}),
            (std::vector<double>{4, 4, 4}));
  EXPECT_EQ(counted.values, 2);
}

TEST(GivenFunction, IsNotCalledForNoPlace) {
  Counted counted;
  EXPECT_TRUE(counted.expression("f(x, y)").at({}).empty());
  EXPECT_EQ(counted.calls, 0);
}

TEST(GivenFunction, MakesAnExpressionDependOnItsArguments) {
  const Counted counted;
  EXPECT_TRUE(counted.expression("g(load)").has_parameters());
  EXPECT_TRUE(counted.expression("g(g(load))").has_parameters());
  EXPECT_FALSE(counted.expression("g(x)").has_parameters());
  EXPECT_FALSE(counted.expression("g(1)").is_constant());
}

TEST(GivenFunction, SeesColumnsOfPoints) {
  const Counted counted;
  const Columns columns{{"heat", {20, 30, 40}}};
  const Expression expression("f(heat, x)", 2, 0.01, load, columns, counted.functions);
  EXPECT_EQ(expression.at(places, std::array{0.0}, std::array<Index, 3>{2, 0, 1}),
            (std::vector<double>{50, 50, 80}));
  EXPECT_THROW((void)expression(places[0], std::array{0.0}), InputError) << "no point, no column";
}

TEST(GivenFunction, PassesItsExceptionsOn) {
  const GivenFunctions functions{{"f", {1, [](auto, auto) { throw std::out_of_range("mine"); }}}};
  const Expression expression("1 + f(x)", 1, 1.0, load, no_columns, functions);
  EXPECT_THROW((void)expression({}), std::out_of_range);
  EXPECT_THROW((void)expression.at(places), std::out_of_range);
}

TEST(GivenFunction, MustBeFiniteWhereItCounts) {
  const GivenFunctions functions{
      {"f", {1, [](auto arguments, auto values) {
               for (std::size_t k = 0; k < values.size(); ++k) {
                 values[k] = arguments[0][k] == 3.0 ? std::numeric_limits<double>::quiet_NaN() : 1;
               }
             }}}};
  const Expression counts("f(x)", 2, 1.0, load, no_columns, functions);
  try {
    (void)counts.at(places, std::array{0.5});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.allowed(),
              "the value at (x, y) = (3, 4), load = 0.5 is nan; it must be finite");
  }
  const Expression beside("x == 3 ? 2 : f(x)", 2, 1.0, load, no_columns, functions);
  EXPECT_EQ(beside.at(places, std::array{0.5}), (std::vector<double>{1, 2, 1}));
}

TEST(GivenFunction, RefusesOtherCalls) {
  const Counted counted;
  EXPECT_EQ(counted.refusal("f(x)"), "the function f takes 2 arguments, not 1");
  EXPECT_EQ(counted.refusal("1 + g()"), "the function g takes 1 argument, not 0");
  EXPECT_EQ(counted.refusal("x > 1 ? 1 : f(x, y, min(1, 2))"),
            "the function f takes 2 arguments, not 3");
  EXPECT_EQ(counted.refusal("2*g"),
            "the function g needs its arguments in parentheses, as in g(x)");
  EXPECT_EQ(counted.refusal("g(x"),
            "not a valid expression: the parenthesis at character 2 is not closed");
  EXPECT_EQ(counted.refusal("1 + g(2 +* x)").substr(0, 37),
            "not a valid expression (character 10)");
  EXPECT_NE(counted.refusal("h(x)").find("unknown function h; allowed are"), std::string::npos);
  EXPECT_NE(counted.refusal("h(x)").find(", f, g"), std::string::npos);
  EXPECT_NE(counted.refusal("g(x) + _0").find("unknown variable _0"), std::string::npos);
  EXPECT_NE(counted.refusal("g(q)").find("unknown variable q"), std::string::npos);
}

TEST(GivenFunction, RefusesNamesThatMeanSomethingElse) {
  const auto fill = [](auto, auto) {};
  for (const std::string name : {"sin", "x", "load", "2f", "a b", ""}) {
    EXPECT_THROW(check_functions({{name, {1, fill}}}), InputError) << name;
  }
  EXPECT_THROW(check_functions({{"f", {0, fill}}}), InputError);
  EXPECT_THROW(check_functions({{"f", {1, {}}}}), InputError);
  EXPECT_NO_THROW(check_functions({{"python_f", {1, fill}}}));
}

}  // namespace
}  // namespace peristat
