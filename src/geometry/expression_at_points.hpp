#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "src/core/expression.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Functions that expressions at points, or of a lattice, may call.
[[nodiscard]] const GivenFunctions& functions_of(const std::shared_ptr<const GivenFunctions>& of);

/// An expression of place, of parameters and of the points' columns.
/// @param points must outlive it
/// @throws InputError as Expression does
[[nodiscard]] Expression expression_of(const std::string& text, const Points& points,
                                       std::vector<std::string> parameters = {});

/// An expression of place, for layers.
/// @param lattice must outlive it
/// @throws InputError as Expression does
[[nodiscard]] Expression expression_of(const std::string& text, const Lattice& lattice);

/// Its value at a point; an image stands at its own place and has the columns of its source.
/// @throws InputError as Expression does
[[nodiscard]] double value_at(const Expression& expression, const Points& points, Index point,
                              std::span<const double> parameters = {});

/// Its values at many points, which given functions find at once.
/// @throws InputError as Expression does
[[nodiscard]] std::vector<double> values_at(const Expression& expression, const Points& points,
                                            std::span<const Index> at,
                                            std::span<const double> parameters = {});

}  // namespace peristat
