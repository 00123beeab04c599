#pragma once

#include <vector>

#include "src/geometry/lattice.hpp"

namespace peristat {

/// Shifts the points that are marked as the body's, in their order, along the lattice's axes by at
/// most its perturbation.
/// @param before points of the body that come before these, and are shifted elsewhere
void perturb(const Lattice& lattice, const std::vector<bool>& is_body, GlobalIndex before,
             Points& points);

}  // namespace peristat
