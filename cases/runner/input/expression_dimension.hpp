#pragma once

#include <optional>
#include <vector>

#include "cases/runner/input/expression_tokens.hpp"

namespace peristat {

/// Dimension of the value of an expression with units: x, y, z, spacing and horizon are lengths, t
/// is a time, and plain numbers and all other variables have no dimension. Zero has any.
/// @return nothing for a value that is zero
/// @throws InputError without key and place if the text is no expression, and if units are added or
/// compared that do not fit, or stand
///         in a function or exponent that takes plain numbers alone
[[nodiscard]] std::optional<Dimension> dimension_of_expression(
    const std::vector<ExpressionToken>& tokens);

}  // namespace peristat
