#pragma once

#include <string>
#include <vector>

#include "cases/runner/input/key_kinds.hpp"
#include "src/geometry/shape.hpp"

namespace peristat {

/// The kind of a shape, whose other keys stand beside this one.
/// @param others keys of the same table that are not the shape's
[[nodiscard]] Kind<Shape> shape_beside(const std::vector<std::string>& others);

/// A shape in a table of its own: { box = { min = [0, 0], max = [1, 1] } }
[[nodiscard]] Kind<Shape> shape_inside();

/// Describes the tables that `shape_inside` reads.
void describe_shapes(std::vector<TableDescription>& all);

/// Adds the keys of all shapes to the table that `shape_beside` stands in.
void add_shapes(const std::vector<TableDescription>& all, TableDescription& to);

}  // namespace peristat
