#pragma once

#include <cstdint>
#include <vector>

#include "src/geometry/solid.hpp"
#include "src/geometry/spacing_field.hpp"

namespace peristat {

/// A box at which random places are aimed, and the number of them that belong there.
struct Target {
  Box box{};
  double count = 0.0;
};

/// Returns `count` random places in a body that keep a distance from one another, in proportion to
/// the spacing at the later one. Darts are thrown at boxes, in proportion to their counts; a dart
/// stays if it hits the body and no place lies within the distance. The distance begins at the
/// spacing and falls by a factor of 1 - 1/(100 count) with every dart that is too near (McCool and
/// Fiume 1992), so that the count is reached in the end: at 0.7 spacings in 2D and 0.8 in 3D, if
/// the spacing is the mean one. The seed alone determines the result.
/// @param targets cover the body, each with a positive count
[[nodiscard]] std::vector<Coordinates> poisson_disk_places(const Solid& body, std::size_t count,
                                                           const SpacingField& spacing,
                                                           const std::vector<Target>& targets,
                                                           std::uint64_t seed);

}  // namespace peristat
