#include "cases/runner/input/expression_dimension.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <string>

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

constexpr Dimension no_dimension{};

[[noreturn]] void refuse_form() { throw InputError("", "", "is not a valid expression"); }

/// None: that of zero, which fits any.
using Measured = std::optional<Dimension>;

std::string dimension_words(const Dimension& dimension) {
  const std::string name = name_of(dimension);
  return name.empty() ? "another dimension" : name;
}

/// The dimension of terms that are added or compared.
Measured common_dimension(const Measured& a, const Measured& b) {
  if (!a || !b) return a ? a : b;
  if (*a == *b) return a;
  throw InputError("", "",
                   "adds or compares " + dimension_words(*a) + " and " + dimension_words(*b) +
                       "; if one number has a unit, every number needs one");
}

void require_plain(const Measured& argument, const std::string& where) {
  if (argument && *argument != no_dimension)
    throw InputError("", "",
                     where + " must have no unit; this one is " + dimension_words(*argument));
}

/// Reads an expression by the ranks of muParser's operators.
class DimensionReader {
 public:
  explicit DimensionReader(const std::vector<ExpressionToken>& tokens) {
    for (const ExpressionToken& token : tokens)
      if (token.kind != ExpressionToken::Kind::blank) tokens_.push_back(&token);
  }

  Measured whole() {
    const Measured value = choice();
    if (at_ < tokens_.size()) refuse_form();
    return value;
  }

 private:
  using Kind = ExpressionToken::Kind;
  /// Deeper than any expression that is meant; the reader calls itself.
  static constexpr int deepest = 200;

  bool take(std::string_view mark) {
    if (at_ == tokens_.size() || !tokens_[at_]->is(mark)) return false;
    ++at_;
    return true;
  }
  template <std::size_t count>
  bool take_one_of(const std::array<std::string_view, count>& marks) {
    return std::ranges::any_of(marks, [&](std::string_view mark) { return take(mark); });
  }

  /// Counts calls that are under way.
  class Deeper {
   public:
    explicit Deeper(int& depth) : depth_(depth) {
      if (++depth_ > deepest)
        throw InputError("", "", "is nested too deeply for an expression with units");
    }
    ~Deeper() { --depth_; }
    Deeper(const Deeper&) = delete;
    Deeper& operator=(const Deeper&) = delete;

   private:
    int& depth_;
  };

  Measured choice() {
    const Deeper deeper(depth_);
    Measured value = logical();
    if (take("?")) {
      value = choice();
      if (!take(":")) refuse_form();
      value = common_dimension(value, choice());
    }
    return value;
  }

  Measured logical() {
    Measured value = comparison();
    while (take_one_of(std::array<std::string_view, 2>{"&&", "||"})) {
      static_cast<void>(comparison());
      value = no_dimension;
    }
    return value;
  }

  Measured comparison() {
    static constexpr std::array<std::string_view, 6> marks{"<=", ">=", "==", "!=", "<", ">"};
    Measured value = sum();
    while (take_one_of(marks)) {
      static_cast<void>(common_dimension(value, sum()));
      value = no_dimension;
    }
    return value;
  }

  Measured sum() {
    Measured value = product();
    while (take_one_of(std::array<std::string_view, 2>{"+", "-"}))
      value = common_dimension(value, product());
    return value;
  }

  Measured product() {
    Measured value = power();
    for (;;) {
      const bool divides = take("/");
      if (!divides && !take("*")) return value;
      const Measured next = power();
      if (!value || !next) {
        value = divides ? value : Measured();
        continue;
      }
      const Unit a{*value}, b{*next};
      value = (divides ? a / b : a * b).dimension;
    }
  }

  Measured power() {
    const Deeper deeper(depth_);
    const Measured base = unary();
    if (!take("^")) return base;
    const std::size_t begin = at_;
    const Measured exponent = power();
    require_plain(exponent, "an exponent");
    if (!base || *base == no_dimension) return base;
    int number = 0;
    const std::string_view text = tokens_[begin]->text;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    constexpr int largest = 20;
    if (at_ != begin + 1 || parsed.ptr != text.data() + text.size() || number > largest)
      throw InputError("", "", "a number with a unit needs a whole number as exponent");
    const Dimension value = Unit{*base}.power(2 * number).dimension;
    constexpr int remote = 1000;  // keeps powers of powers from overflow
    if (std::ranges::any_of(value, [](int e) { return std::abs(e) > remote; })) refuse_form();
    return value;
  }

  Measured unary() {
    while (take_one_of(std::array<std::string_view, 3>{"-", "+", "!"})) {
    }
    return primary();
  }

  Measured primary() {
    if (take("(")) {
      const Measured value = choice();
      if (!take(")")) refuse_form();
      return value;
    }
    if (at_ == tokens_.size()) refuse_form();
    const ExpressionToken& token = *tokens_[at_++];
    if (token.kind == Kind::quantity) return token.unit.dimension;
    if (token.kind == Kind::number)
      return token.text.find_first_not_of("0.") == std::string_view::npos ? Measured()
                                                                          : no_dimension;
    if (token.kind != Kind::word) refuse_form();
    if (take("(")) return function(std::string(token.text));
    if (is_length(token.text)) return unit_of_key("m").dimension;
    return is_time(token.text) ? unit_of_key("s").dimension : no_dimension;
  }

  Measured function(const std::string& name) {
    static constexpr std::array<std::string_view, 5> keeping{"abs", "min", "max", "sum", "avg"};
    const bool keeps = std::ranges::find(keeping, name) != keeping.end();
    const bool turns = name == "sin" || name == "cos" || name == "tan";
    // Tables and functions that a program gives take any argument, and have no unit.
    const bool is_free = name == "table" || why_no_column(name).empty();
    const Measured angle = unit_of_key("rad").dimension;
    Measured value;
    do {
      if (at_ < tokens_.size() && tokens_[at_]->kind == Kind::quote) {
        ++at_;  // the file of a table
        continue;
      }
      const Measured argument = choice();
      if (keeps)
        value = common_dimension(value, argument);
      else if (name == "sqrt")
        value = argument ? root(*argument) : argument;
      else if (name != "sign" && !is_free && !(turns && argument == angle))
        require_plain(argument, "the argument of " + name);
    } while (take(","));
    if (!take(")")) refuse_form();
    return keeps || name == "sqrt" ? value : no_dimension;
  }

  static Dimension root(const Dimension& of) {
    if (std::ranges::any_of(of, [](int exponent) { return exponent % 2 != 0; }))
      throw InputError("", "", "has a root of a root of a unit");
    return Unit{of}.power(1).dimension;
  }

  std::vector<const ExpressionToken*> tokens_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

std::optional<Dimension> dimension_of_expression(const std::vector<ExpressionToken>& tokens) {
  return DimensionReader(tokens).whole();
}

}  // namespace peristat
