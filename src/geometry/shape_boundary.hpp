#pragma once

#include <vector>

#include "src/geometry/shape.hpp"

namespace peristat {

/// The places from + t along, for all t.
struct Line {
  Coordinates from{}, along{};
  [[nodiscard]] Coordinates at(double t) const {
    return {from[0] + t * along[0], from[1] + t * along[1], from[2] + t * along[2]};
  }
};

/// Appends the t at which the line may pass from the inside of the shape to its outside or back:
/// all at which it does, and some at which it does not.
void append_crossings(const Shape& shape, int dimension, const Line& line, std::vector<double>& t);

/// Appends the heights along a direction at which sections across it change abruptly: those of
/// corners, and where the shape begins and ends.
void append_levels(const Shape& shape, int dimension, const Coordinates& direction,
                   std::vector<double>& levels);

/// Lower bound of the distance of a place from the shape's boundary [m].
[[nodiscard]] double distance_to_boundary(const Shape& shape, int dimension,
                                          const Coordinates& place);

}  // namespace peristat
