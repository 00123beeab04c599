#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "src/core/spacing.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// A number as a function of place and of parameters, written as text: operators, functions and
/// comparisons of muParser, the variables x, y, z (those of the dimension) [m], the parameters by
/// their names (`load`), and the constants pi, spacing_x, spacing_y, spacing_z (along the lattice's
/// axes) and, where these are equal, spacing [m]. Decimals have a point, whatever the locale.
///
/// Refuses three forms that muParser accepts but that are hardly ever meant: an assignment (x = 1
/// for x == 1), a chain of comparisons (0 < x < 1 compares a truth value) and several values (1, 2
/// for 1.2).
class Expression {
 public:
  /// @param spacing 0 where there is none
  /// @throws InputError that names the unknown variable or the place of the syntax error, and what
  ///         is allowed; also for a constant that is not finite. Its key is left empty for the
  ///         caller to fill in, its value is the quoted text.
  Expression(const std::string& text, int dimension, const Spacing& spacing,
             std::vector<std::string> parameters = {});
  /// A constant.
  explicit Expression(double value);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Value at a place, for values of the parameters. Not thread-safe on one object.
  /// @throws InputError that names the place and the parameters if the value is not finite
  [[nodiscard]] double operator()(const Coordinates& place,
                                  std::span<const double> parameters = {}) const;

  /// True if the value depends on neither place nor parameters.
  [[nodiscard]] bool is_constant() const;

  /// True if a parameter occurs in it.
  [[nodiscard]] bool has_parameters() const;

  [[nodiscard]] const std::string& text() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace peristat
