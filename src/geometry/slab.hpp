#pragma once

#include "src/core/communicator.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/part.hpp"

namespace peristat {

/// A part of the points that make_points gives, without ghosts: those of a slab of the lattice's
/// rows, which follow one another. Nobody makes more than a slab and planes of layers beside it.
/// There are ranks without points where there are more of them than rows.
/// @throws InputError on all ranks as make_points does, and for what slabs don't tell yet: blue
///         noise, lattices that are turned, cells that are cut or perturbed
[[nodiscard]] Part make_slab(const Lattice& lattice, const Communicator& ranks);

}  // namespace peristat
