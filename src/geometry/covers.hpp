#pragma once

#include <vector>

#include "src/geometry/collared_body.hpp"
#include "src/geometry/lattice.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Covers of the body's flat outermost sides by the layers of a lattice; safe for threads.
/// @param places of points in the body, those of this rank (collective)
/// @throws InputError ("layers[k].side", "layers[k].where") if the body has no flat side there
[[nodiscard]] std::vector<Cover> covers_of(const Lattice& lattice,
                                           const std::vector<Coordinates>& places,
                                           const Communicator& ranks = SoleRank());

}  // namespace peristat
