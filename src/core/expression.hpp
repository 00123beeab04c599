#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "src/core/given_function.hpp"
#include "src/core/spacing.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// Data of points by their names: a value per point.
using Columns = std::map<std::string, std::vector<double>>;

/// Why data of points can't have this name, which expressions could not use; empty: they can.
[[nodiscard]] std::string why_no_column(const std::string& name);

/// A number as a function of place and of parameters, written as text: operators, functions and
/// comparisons of muParser, the variables x, y, z (those of the dimension) [m], the parameters by
/// their names (`load`), columns of the points by theirs, and the constants pi, spacing_x,
/// spacing_y, spacing_z (along the lattice's axes) and, where these are equal, spacing [m].
/// Decimals have a point, whatever the locale.
///
/// table("file.csv", x) and table("file.csv", "column", x) are the LinearTable of a file at x; a
/// place outside the table is refused.
///
/// Functions that a program gives are called by their names. Their arguments are expressions, too,
/// and are evaluated wherever the expression is, whichever branch of a condition holds there.
///
/// Refuses three forms that muParser accepts but that are hardly ever meant: an assignment (x = 1
/// for x == 1), a chain of comparisons (0 < x < 1 compares a truth value) and several values (1, 2
/// for 1.2).
class Expression {
 public:
  /// No point: the value is that of a place alone.
  static constexpr Index no_point = -1;

  /// @param spacing 0 where there is none
  /// @param columns must outlive it; without values, it can't be evaluated if it has one of them
  /// @param functions must outlive it
  /// @throws InputError that names the unknown variable or the place of the syntax error, and what
  ///         is allowed; also for a constant that is not finite. Its key is left empty for the
  ///         caller to fill in, its value is the quoted text.
  Expression(const std::string& text, int dimension, const Spacing& spacing,
             std::vector<std::string> parameters = {}, const Columns& columns = none,
             const GivenFunctions& functions = no_functions);
  /// A constant.
  explicit Expression(double value);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Value at a place, for values of the parameters. Not thread-safe on one object.
  /// @param point whose values columns have
  /// @throws InputError that names the place and the parameters if the value is not finite, and if
  ///         it needs a column but the place is no point
  [[nodiscard]] double operator()(const Coordinates& place, std::span<const double> parameters = {},
                                  Index point = no_point) const;

  /// Values at many places, as by the above; each call of a given function is one for all places.
  /// @param points of the places; empty: no points
  [[nodiscard]] std::vector<double> at(std::span<const Coordinates> places,
                                       std::span<const double> parameters = {},
                                       std::span<const Index> points = {}) const;

  /// True if the value depends on neither place nor parameters nor columns.
  [[nodiscard]] bool is_constant() const;

  /// True if a parameter occurs in it.
  [[nodiscard]] bool has_parameters() const;

  [[nodiscard]] const std::string& text() const;

 private:
  static const Columns none;
  static const GivenFunctions no_functions;

  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace peristat
