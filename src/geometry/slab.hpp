#pragma once

#include "src/geometry/lattice.hpp"
#include "src/geometry/part.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// A slab of the points of make_points, without ghosts, with consecutive numbers. No rank makes
/// more than a slab and a few rows beside it. With more ranks than rows, some ranks have no points.
/// Collective.
/// @throws InputError as make_points does, for an expression without a value perhaps on one rank
///         alone; and for blue noise
[[nodiscard]] Part make_slab(const Lattice& lattice, const Communicator& ranks);

}  // namespace peristat
