#pragma once

#include "src/geometry/points.hpp"

namespace peristat {

/// Points of a body from those that a program gives, as read_points makes them of a file's: with
/// the mean spacing, and renumbered with locality. `source_row` has their numbers as given.
/// @param given dimension, reference, volume, sets (of numbers from 0) and columns; nothing else of
///        it is used
/// @param length_unit unit of the coordinates, whose cube is that of the volumes [m]
/// @throws InputError ("points.…") for arrays of other lengths than there are points, values that
///         are not finite, volumes that are not positive, names that can't be used, members of sets
///         that are no points, and two points at one place
[[nodiscard]] Points points_of_given(const Points& given, double cross_section,
                                     double length_unit = 1.0);

}  // namespace peristat
