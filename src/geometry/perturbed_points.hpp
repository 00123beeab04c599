#pragma once

#include <vector>

#include "src/geometry/lattice.hpp"

namespace peristat {

/// Shifts the points marked as the body's, in their order, along the lattice's axes by at most the
/// lattice's perturbation.
/// @param before number of the body's points on lower ranks, whose random numbers are skipped
void perturb(const Lattice& lattice, const std::vector<bool>& is_body, GlobalIndex before,
             Points& points);

}  // namespace peristat
