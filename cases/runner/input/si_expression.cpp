#include "cases/runner/input/si_expression.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "cases/runner/input/expression_dimension.hpp"
#include "cases/runner/input/expression_tokens.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

using TokenKind = ExpressionToken::Kind;
using Tokens = std::vector<ExpressionToken>;

/// "*0.001", or "/1000" in the same place: powers of ten are exact in this form.
std::string times(const Unit& unit, bool inverse) {
  if (unit.factor != 1.0L || unit.half_tens % 2 != 0)
    return (inverse ? "/" : "*") + number_text(unit.size());
  const bool divides = (unit.half_tens < 0) != inverse;
  return (divides ? "/" : "*") + number_text(std::pow(10.0, std::abs(unit.half_tens) / 2));
}

std::string si_number(std::string_view number, const Unit& unit) {
  const std::optional<double> value = in_unit(number, unit);
  if (value) return number_text(*value);
  throw InputError("", "", "has a number that is too large or too small");
}

/// A token, with its variable in the units of the table.
std::string converted(const ExpressionToken& token, const UnitSystem& units) {
  const std::string text(token.text);
  if (token.kind == TokenKind::quantity)
    return si_number(token.number, token.unit / units.unit_of(token.unit.dimension));
  if (token.kind != TokenKind::word) return text;
  const Unit unit = is_length(token.text) ? units.length
                    : is_time(token.text) ? units.time
                                          : Unit();
  return unit.has_size_of({}) ? text : "(" + text + times(unit, true) + ")";
}

/// True if the tokens from the given one on are a product: no operator that binds less tightly, and
/// no power of the first one, stands outside of parentheses.
bool is_product(const Tokens& tokens, std::size_t first) {
  std::size_t next = first + 1;
  while (next < tokens.size() && tokens[next].kind == TokenKind::blank) ++next;
  if (next == tokens.size()) return true;
  if (!tokens[next].is("*") && !tokens[next].is("/")) return false;
  int depth = 0;
  for (; next < tokens.size(); ++next) {
    if (tokens[next].kind != TokenKind::mark) continue;
    const std::string_view mark = tokens[next].text;
    depth += mark == "(" ? 1 : mark == ")" ? -1 : 0;
    const bool binds = mark == "*" || mark == "/" || mark == "^" || mark == "(" || mark == ")";
    if (depth < 0 || (depth == 0 && !binds)) return false;
  }
  return true;
}

/// Place of the number that the value is a multiple of; nothing if there is none.
std::optional<std::size_t> leading_number(const Tokens& tokens) {
  for (std::size_t k = 0; k < tokens.size(); ++k) {
    if (tokens[k].kind == TokenKind::blank || tokens[k].is("-")) continue;
    const bool is_number =
        tokens[k].kind == TokenKind::number || tokens[k].kind == TokenKind::quantity;
    return is_number && is_product(tokens, k) ? std::optional(k) : std::nullopt;
  }
  return std::nullopt;
}

/// Refuses units that do not fit together, or do not give the dimension of the value.
void check_units(const Tokens& tokens, const std::optional<UnitOfValue>& of_value) {
  if (std::ranges::find(tokens, TokenKind::quantity, &ExpressionToken::kind) == tokens.end())
    return;
  const std::optional<Dimension> found = dimension_of_expression(tokens);
  if (!found || !of_value || *found == of_value->si.dimension) return;
  const auto words = [](const Dimension& dimension) {
    const std::string name = name_of(dimension);
    return name.empty() ? "of another dimension" : name;
  };
  throw InputError("", "",
                   "has a value that is " + words(*found) + "; must be " +
                       words(of_value->si.dimension) +
                       ". In an expression with units x, y, z and spacing are lengths, t is a "
                       "time, and a plain number has no unit");
}

}  // namespace

std::string in_si(const std::string& expression, const UnitSystem& units,
                  const std::optional<UnitOfValue>& of_value) {
  if (expression == "free") return expression;
  const Tokens tokens = tokens_of(expression);
  check_units(tokens, of_value);
  const Unit scale = of_value ? of_value->given / of_value->si : Unit();
  const bool is_scaled = !scale.has_size_of({});
  const auto leading = is_scaled ? leading_number(tokens) : std::nullopt;
  std::string text;
  for (std::size_t k = 0; k < tokens.size(); ++k) {
    const ExpressionToken& token = tokens[k];
    if (leading != k)
      text += converted(token, units);
    else if (token.kind == TokenKind::number)
      text += si_number(token.text, scale);
    else
      text += si_number(token.number, token.unit / units.unit_of(token.unit.dimension) * scale);
  }
  return is_scaled && !leading ? "(" + text + ")" + times(scale, false) : text;
}

}  // namespace peristat
