#pragma once

#include <span>
#include <string>

#include "src/geometry/points.hpp"

namespace peristat {

/// Adds the value of an expression of x, y, z and the points' columns to the entries of the points
/// of a set; of all points but images if the set is empty.
/// @param key    of the table, for errors: "initial[0]"
/// @param member of the table that has the expression: "velocity[1]"
/// @param stride, offset position of a point's entry: values[point * stride + offset]
/// @throws InputError for a set that is unknown or empty, a bad expression, and a value that is not
///         finite, with its place
void add_field_of_place(const Points& points, const std::string& set, const std::string& text,
                        const std::string& key, const std::string& member, std::size_t stride,
                        std::size_t offset, std::span<double> values);

}  // namespace peristat
