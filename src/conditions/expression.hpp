#pragma once

#include <memory>
#include <string>
#include <vector>

#include "src/types.hpp"

namespace peristat {

/// A number as a function of place and load factor, written as text: operators, functions and
/// comparisons of muParser, the variables x, y, z (those of the dimension) [m] and, where allowed,
/// `load`, and the constants pi and spacing.
class Expression {
 public:
  enum class LoadFactor { allowed, not_allowed };

  /// @throws InputError that names the unknown variable or the place of the syntax error, and what is
  ///         allowed (its key is left empty for the caller to fill in)
  Expression(const std::string& text, int dimension, double spacing, LoadFactor load_factor);
  /// A constant.
  explicit Expression(double value);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Value at a place and load factor. Not thread-safe on one object.
  /// @throws InputError if the value is not finite
  [[nodiscard]] double operator()(const Coordinates& place, double load_factor = 0.0) const;

  [[nodiscard]] const std::string& text() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace peristat
