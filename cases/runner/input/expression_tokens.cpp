#include "cases/runner/input/expression_tokens.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

using Token = ExpressionToken;

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
/// Letters, %, and the bytes of µ, °, ² and ³.
bool is_in_symbol(char c) {
  return is_in_word(c) || c == '%' || static_cast<unsigned char>(c) >= 0x80;
}

std::size_t count_in_front(std::string_view text, bool (*belongs)(char)) {
  return std::size_t(std::ranges::find_if_not(text, belongs) - text.begin());
}

/// Length of a symbol of a unit with its exponent, "mm^2"; 0 if there is none.
std::size_t length_of_symbol(std::string_view text) {
  if (text.empty() || !is_in_symbol(text[0]) || is_digit(text[0]) || text[0] == '_') return 0;
  const std::size_t symbol = count_in_front(text, is_in_symbol);
  if (text.substr(symbol, 1) != "^") return symbol;
  const std::size_t sign = text.substr(symbol + 1, 1) == "-" ? 1 : 0;
  const std::size_t digits = count_in_front(text.substr(symbol + 1 + sign), is_digit);
  return digits > 0 ? symbol + 1 + sign + digits : symbol;
}

/// True for a symbol of a unit that is neither a variable, "t^2", nor a function, "min(load, 1)".
bool is_unit(std::string_view symbol, std::string_view behind) {
  const std::string_view word = symbol.substr(0, symbol.find('^'));
  const std::size_t blanks = count_in_front(behind, is_space);
  std::string why_not;
  return !is_length(word) && !is_time(word) && behind.substr(blanks, 1) != "(" &&
         parse_unit(symbol, why_not).has_value();
}

/// Length of a unit: symbols joined by * and / without blanks, also behind "1/". What follows the
/// first one belongs to the unit only if it is one, and no variable.
std::size_t length_of_unit(std::string_view text) {
  const std::size_t begin = text.starts_with("1/") ? 2 : 0;
  const std::size_t first = length_of_symbol(text.substr(begin));
  std::size_t length = first > 0 ? begin + first : 0;
  while (length > 0 && (text.substr(length, 1) == "/" || text.substr(length, 1) == "*")) {
    const std::string_view rest = text.substr(length + 1);
    const std::string_view symbol = rest.substr(0, length_of_symbol(rest));
    if (symbol.empty() || !is_unit(symbol, rest.substr(symbol.size()))) break;
    length += 1 + symbol.size();
  }
  return length;
}

Token number_or_quantity(std::string_view rest, std::size_t number) {
  const std::size_t blanks = count_in_front(rest.substr(number), is_space);
  const std::size_t unit = length_of_unit(rest.substr(number + blanks));
  if (unit == 0) return {Token::Kind::number, rest.substr(0, number), {}};
  const std::string_view name = rest.substr(number + blanks, unit);
  std::string why_not;
  const auto parsed = parse_unit(name, why_not);
  if (!parsed) {
    throw InputError("", "",
                     why_not + ". A word after a number is its unit; write a product with *");
  }
  return {Token::Kind::quantity, rest.substr(0, number + blanks + unit), rest.substr(0, number),
          *parsed};
}

Token first_token(std::string_view rest) {
  const char c = rest[0];
  if (is_space(c)) return {Token::Kind::blank, rest.substr(0, count_in_front(rest, is_space)), {}};
  const std::size_t number = is_digit(c) || c == '.' ? length_of_number(rest) : 0;
  if (number > 0) return number_or_quantity(rest, number);
  if (is_in_word(c))
    return {Token::Kind::word, rest.substr(0, count_in_front(rest, is_in_word)), {}};
  if (c == '"' || c == '\'')
    return {Token::Kind::quote, rest.substr(0, std::min(rest.find(c, 1), rest.size() - 1) + 1), {}};
  static constexpr std::array<std::string_view, 6> pairs{"<=", ">=", "==", "!=", "&&", "||"};
  const bool is_pair = std::ranges::find(pairs, rest.substr(0, 2)) != pairs.end();
  return {Token::Kind::mark, rest.substr(0, is_pair ? 2 : 1), {}};
}

}  // namespace

std::vector<ExpressionToken> tokens_of(std::string_view expression) {
  std::vector<Token> tokens;
  while (!expression.empty()) {
    tokens.push_back(first_token(expression));
    expression.remove_prefix(tokens.back().text.size());
  }
  return tokens;
}

bool is_length(std::string_view word) {
  static constexpr std::array<std::string_view, 8> lengths{
      "x", "y", "z", "spacing", "spacing_x", "spacing_y", "spacing_z", "horizon"};
  return std::ranges::find(lengths, word) != lengths.end();
}

bool is_time(std::string_view word) { return word == "t"; }

}  // namespace peristat
