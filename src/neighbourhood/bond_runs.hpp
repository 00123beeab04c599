#pragma once

#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Consecutive points whose bonds are alike: as many, to partners that are as many points ahead,
/// with the same lengths and weights.
struct BondRun {
  Index first, last;  ///< the last one is not part of it
};

/// Fewest points that make a run.
inline constexpr Index least_run = 8;

/// Runs of a body, ascending. On a lattice they are parts of its rows, where holes, cracks and the
/// surface leave alike bonds. Bonds to ghosts are in none.
[[nodiscard]] std::vector<BondRun> bond_runs(const Points& points, const Bonds& bonds, int threads);

/// Share of the bonds that are in runs, from 0 to 1.
[[nodiscard]] double share_in_runs(const Points& points, const Bonds& bonds, int threads);

}  // namespace peristat
