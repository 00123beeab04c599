#pragma once

#include "src/geometry/lattice.hpp"

namespace peristat {

/// Refuses a subtracted shape that takes nothing away: one whose inside has no place of the lattice
/// that the steps before have put into the body. Where cells are cut at boundaries, or points stand
/// at random, a shape takes something wherever it overlaps with the box around the body.
/// @throws InputError ("shapes[1].action")
void refuse_idle_shapes(const Lattice& lattice);

}  // namespace peristat
