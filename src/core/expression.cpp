#include "src/core/expression.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <muParser.h>

#include "src/core/input_error.hpp"
#include "src/core/nearest_name.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// muParser takes fewer than 20 000 characters.
constexpr std::size_t longest_text = 19'999;

}  // namespace

struct Expression::Parser {
  std::string text;
  int dimension = 3;
  std::vector<std::string> constants;
  std::vector<std::string> parameters;
  std::optional<double> constant;
  mu::Parser parser;
  // Variables of the parser point at these; this struct therefore never moves.
  Coordinates place{};
  std::vector<double> values;  // of the parameters

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("", '"' + text + '"', what);
  }

  [[noreturn]] void refuse_parse(const mu::ParserError& error) const {
    const std::string where =
        error.GetPos() >= 0 ? " (character " + std::to_string(error.GetPos() + 1) + ")" : "";
    std::string what = error.GetMsg();
    // Drops the position that muParser counts from 0; `where` counts from 1.
    const std::size_t position = what.find(" at position ");
    if (position != std::string::npos) {
      const std::size_t end = what.find_first_not_of("0123456789", position + 13);
      what.erase(position, std::min(end, what.size()) - position);
    }
    refuse("not a valid expression" + where + ": " + what);
  }

  void define(const std::string& name, double value) {
    parser.DefineConst(name, value);
    constants.push_back(name);
  }

  void define(const Spacing& spacing) {
    parser.ClearConst();  // _pi and _e
    define("pi", std::numbers::pi);
    if (spacing > 0.0) {
      if (spacing.is_square()) define("spacing", spacing);
      for (int c = 0; c < dimension; ++c)
        define(std::string("spacing_") + "xyz"[c], spacing.along(c));
    }
    for (int c = 0; c < dimension; ++c) parser.DefineVar(std::string(1, "xyz"[c]), &place[c]);
    values.resize(parameters.size());
    for (std::size_t k = 0; k < values.size(); ++k) parser.DefineVar(parameters[k], &values[k]);
  }

  [[noreturn]] void refuse_word(const std::string& word, bool is_called) const {
    std::vector<std::string> variables{"x", "y", "z"}, functions;
    variables.resize(dimension);
    variables.insert(variables.end(), parameters.begin(), parameters.end());
    variables.insert(variables.end(), constants.begin(), constants.end());
    for (const auto& [name, callback] : parser.GetFunDef()) functions.push_back(name);

    std::vector<std::string> allowed = is_called ? functions : variables;
    std::string what = (is_called ? "unknown function " : "unknown variable ") + word + "; allowed";
    for (const std::string& name : allowed) what += (name == allowed[0] ? " are " : ", ") + name;
    // Correctly spelt, but not defined in this dimension or for this key.
    for (const char* known : {"x", "y", "z", "load", "t"}) {
      if (word == known) refuse(what);
    }
    // The parentheses of a function may have been forgotten.
    if (!is_called) allowed.insert(allowed.end(), functions.begin(), functions.end());
    const std::string nearest = nearest_name(word, allowed);
    refuse(what + (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }

  /// Reads the text once for unknown words, a single '=' and a second comparison beside another
  /// one, which muParser does not report or silently accepts.
  /// @return whether a variable occurs
  bool scan() const {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto is_word = [&](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || is_digit(c);
    };
    const auto at = [&](std::size_t i) { return i < text.size() ? text[i] : '\0'; };
    bool varies = false;
    std::vector<bool> compared{false};  // per open parenthesis: a comparison stands to the left
    for (std::size_t i = 0; i < text.size();) {
      const char c = text[i];
      if (is_digit(c) || c == '.') {
        while (is_digit(at(i)) || at(i) == '.') ++i;
        const bool is_signed = at(i + 1) == '+' || at(i + 1) == '-';
        if ((at(i) == 'e' || at(i) == 'E') && is_digit(at(i + 1 + is_signed))) {
          for (i += 1 + is_signed; is_digit(at(i));) ++i;
        }
      } else if (is_word(c)) {
        std::size_t end = i, next;
        while (is_word(at(end))) ++end;
        for (next = end; at(next) == ' ';) ++next;
        const std::string word = text.substr(i, end - i);
        const bool is_variable = parser.GetVar().count(word) > 0;
        if (!is_variable && !parser.GetConst().count(word) && !parser.GetFunDef().count(word)) {
          refuse_word(word, at(next) == '(');
        }
        varies = varies || is_variable;
        i = end;
      } else if (c == '<' || c == '>' || c == '=' || (c == '!' && at(i + 1) == '=')) {
        const bool two_characters = at(i + 1) == '=';
        if (c == '=' && !two_characters) {
          refuse("'=' at character " + std::to_string(i + 1) + " assigns; == compares");
        }
        if (compared.back()) {
          refuse("the comparison at character " + std::to_string(i + 1) +
                 " would compare the truth value of the one before; join the two with &&");
        }
        compared.back() = true;
        i += two_characters ? 2 : 1;
      } else {
        if (c == '*' && at(i + 1) == '*') {
          refuse("'**' at character " + std::to_string(i + 1) +
                 " is no operator; a power is written with ^, as in load^2");
        }
        if (c == '(') compared.push_back(false);
        if (c == ')' && compared.size() > 1) compared.pop_back();
        if (c == '&' || c == '|' || c == '?' || c == ':' || c == ',') compared.back() = false;
        ++i;
      }
    }
    return varies;
  }

  void compile() {
    // A multi-line string of the case file is one line here; muParser refuses line breaks.
    for (char& c : text) {
      if (c == '\n' || c == '\r' || c == '\t') c = ' ';
    }
    if (text.find_first_not_of(' ') == std::string::npos) {
      refuse("an expression must not be empty; allowed is a number or an expression");
    }
    if (text.size() > longest_text) {
      refuse("an expression may have at most " + std::to_string(longest_text) +
             " characters; this one has " + std::to_string(text.size()));
    }
    // muParser stops silently at a zero character.
    if (text.find('\0') != std::string::npos)
      refuse("an expression must not hold a zero character");
    const bool varies = scan();
    try {
      parser.SetExpr(text);
      int count = 0;
      const double first = *parser.Eval(count);
      if (count != 1) refuse("an expression has one value; a decimal point is '.', not ','");
      if (!varies) constant = first;
    } catch (const mu::ParserError& error) {
      refuse_parse(error);
    }
    if (constant && !std::isfinite(*constant)) {
      refuse("the value is " + number_text(*constant) + "; it must be finite");
    }
  }

  double value() {
    double result = 0.0;
    try {
      result = parser.Eval();
    } catch (const mu::ParserError& error) {
      refuse_parse(error);
    }
    if (!std::isfinite(result)) {
      // Without a dimension (total forces) only the parameters say where.
      static constexpr const char* names[] = {"", "(x) = ", "(x, y) = ", "(x, y, z) = "};
      std::string where = names[dimension];
      if (dimension > 0) where += place_text(place, dimension);
      for (std::size_t k = 0; k < values.size(); ++k) {
        where += (where.empty() ? "" : ", ") + parameters[k] + " = " + number_text(values[k]);
      }
      refuse("the value at " + where + " is " + number_text(result) + "; it must be finite");
    }
    return result;
  }
};

Expression::Expression(const std::string& text, int dimension, const Spacing& spacing,
                       std::vector<std::string> parameters)
    : parser_(std::make_unique<Parser>()) {
  parser_->text = text;
  parser_->dimension = dimension;
  parser_->parameters = std::move(parameters);
  parser_->define(spacing);
  parser_->compile();
}

Expression::Expression(double value) : parser_(std::make_unique<Parser>()) {
  parser_->text = number_text(value);
  parser_->constant = value;
  if (!std::isfinite(value)) parser_->refuse("the value must be finite");
}

Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

double Expression::operator()(const Coordinates& place, std::span<const double> parameters) const {
  if (parser_->constant) return *parser_->constant;
  parser_->place = place;
  std::copy_n(parameters.begin(), std::min(parameters.size(), parser_->values.size()),
              parser_->values.begin());
  return parser_->value();
}

bool Expression::is_constant() const { return parser_->constant.has_value(); }

bool Expression::has_parameters() const {
  if (parser_->constant) return false;
  const mu::varmap_type& used = parser_->parser.GetUsedVar();
  return std::ranges::any_of(parser_->parameters,
                             [&](const std::string& name) { return used.contains(name); });
}

const std::string& Expression::text() const { return parser_->text; }

}  // namespace peristat
