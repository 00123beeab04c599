#pragma once

#include "solvers/body/body.hpp"

namespace peristat {

/// Body size for the memory estimate.
[[nodiscard]] BodySize size_of(const Points& points);

/// True for up to 100 000 points: the body's freed memory stays with the process.
[[nodiscard]] bool is_small(const Points& points);

/// Radius, in spacings, of a ball with the volume of all cells that a point sees parts of: the
/// horizon ratio itself unless partial volumes are exact. By Steiner's formula the mean number of
/// cells of edge 1 that meet a ball of radius m is 2m + 1, pi m^2 + 4m + 1 and 4/3 pi m^3 + 3 pi
/// m^2 + 6m + 1.
[[nodiscard]] double reach_ratio(VolumeCorrection correction, HorizonShape shape, int dimension,
                                 double horizon_ratio);

/// Expected number of bonds of so many points, from horizon and dimension alone.
[[nodiscard]] double expected_bonds(double points, int dimension, double horizon_ratio);

/// Memory estimate from the counts of the body.
[[nodiscard]] MemoryEstimate estimate_memory(const Body& body);

}  // namespace peristat
