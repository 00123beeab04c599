#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>

namespace peristat {

/// A function that a program gives, for expressions to call by its name. Its values must depend on
/// its arguments alone: it may be called for loads that no step of a run has.
struct GivenFunction {
  int arguments = 1;  ///< their number, at least 1
  /// Evaluates the function at many points at once. Each argument has as many entries as there are
  /// values, or one where it is the same for all. What it throws reaches the caller unchanged.
  std::function<void(std::span<const std::span<const double>> arguments, std::span<double> values)>
      fill;
};

/// Functions by their names.
using GivenFunctions = std::map<std::string, GivenFunction>;

/// Refuses names that expressions can't use (see why_no_column), functions without arguments, and
/// those that are empty.
/// @throws InputError ("functions") that names the function
void check_functions(const GivenFunctions& functions);

}  // namespace peristat
