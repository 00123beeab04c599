#pragma once

#include "src/geometry/lattice.hpp"

namespace peristat {

/// Refuses a subtracted shape that removes nothing: one that contains no lattice place which the
/// steps before have put into the body. With cells cut at boundaries, or random points, a shape
/// removes something if it overlaps the box around the body.
/// @throws InputError ("shapes[1].action")
void refuse_idle_shapes(const Lattice& lattice);

}  // namespace peristat
