#pragma once

#include <span>
#include <string>
#include <vector>

#include "src/core/expression.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// An expression of place, of parameters and of the points' columns.
/// @param points must outlive it
/// @throws InputError as Expression does
[[nodiscard]] Expression expression_of(const std::string& text, const Points& points,
                                       std::vector<std::string> parameters = {});

/// Its value at a point; an image stands at its own place and has the columns of its source.
/// @throws InputError as Expression does
[[nodiscard]] double value_at(const Expression& expression, const Points& points, Index point,
                              std::span<const double> parameters = {});

}  // namespace peristat
