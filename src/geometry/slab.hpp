#pragma once

#include "src/core/communicator.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/part.hpp"

namespace peristat {

/// A part of the points that make_points gives, without ghosts: those of a slab of the body, which
/// follow one another. Nobody makes more than a slab and a few rows beside it. There are ranks
/// without points where there are more of them than rows. A call that all make.
/// @throws InputError as make_points does, an expression without a value perhaps on one rank alone;
///         and for blue noise
[[nodiscard]] Part make_slab(const Lattice& lattice, const Communicator& ranks);

}  // namespace peristat
