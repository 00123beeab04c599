#pragma once

#include "src/core/communicator.hpp"
#include "src/geometry/part.hpp"
#include "src/materials/quadrature.hpp"

namespace peristat {

/// How far ghosts must reach for the bonds of a part [m]: as far as these, twice where a surface
/// correction asks for what the neighbours of a point see. A call that all ranks make.
/// @param points those of the rank, without ghosts or with them
[[nodiscard]] double reach_of_bonds(const Points& points, SurfaceCorrection surface,
                                    const BondSetting& setting, const Communicator& ranks);

/// The bonds of a body that a part has: every one with a point that its rank owns, with the weights
/// of make_bonds. A bond of points of two ranks is on both, with the same bits (agree_on_kinds);
/// none is between ghosts. A call that all make.
/// @throws std::logic_error if the part's ghosts don't reach as far as reach_of_bonds
[[nodiscard]] Bonds make_bonds(const Part& part, SurfaceCorrection surface,
                               const BondSetting& setting, const Communicator& ranks, int threads);

/// Bonds of the whole body that have a weight, each counted once.
/// @param points of the rank
[[nodiscard]] GlobalIndex count_bonds(const Points& points, const Bonds& bonds,
                                      const Communicator& ranks);

}  // namespace peristat
