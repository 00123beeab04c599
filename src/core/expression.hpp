#pragma once

#include <memory>
#include <string>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// A number as a function of place and load factor, written as text: operators, functions and
/// comparisons of muParser, the variables x, y, z (those of the dimension) [m] and, where allowed,
/// `load`, and the constants pi and spacing [m]. Decimals have a point, whatever the locale.
///
/// What muParser takes but hardly anyone means is refused: an assignment (x = 1 for x == 1), a
/// chain of comparisons (0 < x < 1 compares a truth value) and several values (1, 2 for 1.2).
class Expression {
 public:
  enum class LoadFactor { allowed, not_allowed };

  /// @throws InputError that names the unknown variable or the place of the syntax error, and what
  ///         is allowed; also for a constant that is not finite. Its key is left empty for the
  ///         caller to fill in, its value is the quoted text.
  Expression(const std::string& text, int dimension, double spacing, LoadFactor load_factor);
  /// A constant.
  explicit Expression(double value);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Value at a place and load factor. Not thread-safe on one object.
  /// @throws InputError that names the place and the load factor if the value is not finite
  [[nodiscard]] double operator()(const Coordinates& place, double load_factor = 0.0) const;

  /// Whether the value depends on neither place nor load factor.
  [[nodiscard]] bool is_constant() const;

  [[nodiscard]] const std::string& text() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace peristat
