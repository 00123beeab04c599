#pragma once

#include <vector>

#include "src/core/communicator.hpp"
#include "src/geometry/collared_body.hpp"
#include "src/geometry/lattice.hpp"

namespace peristat {

/// What the layers of a lattice cover of the body's flat outermost sides; safe for threads.
/// @param places of points in the body, of those that ranks have: a call that all make
/// @throws InputError ("layers[k].side", "layers[k].where") if the body has no flat side there
[[nodiscard]] std::vector<Cover> covers_of(const Lattice& lattice,
                                           const std::vector<Coordinates>& places,
                                           const Communicator& ranks = SoleRank());

}  // namespace peristat
