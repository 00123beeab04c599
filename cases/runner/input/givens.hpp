#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "src/core/given_function.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// What a program gives beside the text of a case.
struct Givens {
  /// Functions that expressions of the case may call. As all that is in an expression, arguments
  /// and values are in the case's units.
  GivenFunctions functions{};
  /// Points in place of those of points.file: their dimension, reference, volume, sets and columns,
  /// as they would stand in the file (coordinates and volumes in points.length_unit).
  std::optional<Points> points{};

  [[nodiscard]] bool none() const { return functions.empty() && !points; }
};

/// In front of what a program gives, where lines of files are beside it.
inline constexpr std::string_view mark_of_given = "given ";

/// A line for each thing that is given: "given function NAME", and "given points".
[[nodiscard]] std::string lines_of(const Givens& givens);

/// Refuses to resume a run without what its program gave.
/// @param lines of the files and givens that the run had
/// @throws InputError without a key
void require_givens(const std::string& lines, const Givens& givens);

}  // namespace peristat
