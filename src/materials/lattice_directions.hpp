#pragma once

#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// A direction and its share of a mean; the shares of a list add up to 1.
struct WeightedDirection {
  Coordinates normal;
  double weight;
};

/// Directions spread evenly over half of the circle or the sphere; none in 1D.
[[nodiscard]] std::vector<Coordinates> even_directions(int dimension, int count);

/// Directions of one of the 8 or 48 sectors that a square or cubic lattice repeats, by Gauss's
/// rule: the angle from 0 to pi/4 (2D, 12 directions), or y and z/y of n ~ (1, y, z), both from 0
/// to 1 (3D, 4 x 4), weighted by the solid angle.
[[nodiscard]] std::vector<WeightedDirection> sector_directions(int dimension);

/// Corners of that sector: an axis, and the diagonals of a square or a cube.
[[nodiscard]] std::vector<Coordinates> sector_corners(int dimension);

}  // namespace peristat
