#pragma once

#include <vector>

#include "src/geometry/collared_body.hpp"
#include "src/geometry/lattice.hpp"

namespace peristat {

/// What the layers of a lattice cover of the body's flat outermost sides; safe for threads.
/// @param places of points in the body
/// @throws InputError ("layers[k].side", "layers[k].where") if the body has no flat side there
[[nodiscard]] std::vector<Cover> covers_of(const Lattice& lattice,
                                           const std::vector<Coordinates>& places);

}  // namespace peristat
