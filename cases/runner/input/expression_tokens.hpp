#pragma once

#include <string_view>
#include <vector>

#include "cases/runner/input/quantity.hpp"

namespace peristat {

/// A piece of the text of an expression. All pieces joined are the text.
struct ExpressionToken {
  enum class Kind { blank, number, quantity, word, quote, mark };

  Kind kind = Kind::mark;
  std::string_view text;    ///< of a quantity with its unit
  std::string_view number;  ///< of a quantity: without it
  Unit unit{};              ///< of a quantity

  [[nodiscard]] bool is(std::string_view mark) const { return kind == Kind::mark && text == mark; }
};

/// The tokens of an expression, which the text must outlive. A word behind a number is its unit:
/// "0.1 mm", "5 N/mm^2".
/// @throws InputError without key and place for a word there that is no unit
[[nodiscard]] std::vector<ExpressionToken> tokens_of(std::string_view expression);

/// True for x, y, z, spacing, spacing_x… and horizon, the variables that are lengths.
[[nodiscard]] bool is_length(std::string_view word);

/// True for t.
[[nodiscard]] bool is_time(std::string_view word);

}  // namespace peristat
