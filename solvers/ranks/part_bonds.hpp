#pragma once

#include "assembly/terms/term.hpp"
#include "src/geometry/part.hpp"
#include "src/materials/quadrature.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Which of a body's bonds a part has. A bond between points of two ranks is on both.
enum class PartBonds {
  of_owned,          ///< all with a point that its rank owns
  among_neighbours,  ///< and those between neighbours of owned points, edges of triangles
  of_neighbours  ///< all of owned points and of their neighbours, which then have complete states
};

/// Distance that ghosts must reach for the bonds of a part [m]: the search radius of bonds, once
/// more for bonds of neighbours, and once more for a surface correction, which needs the neighbours
/// of neighbours. Collective.
/// @param points of the rank, with or without ghosts
[[nodiscard]] double reach_of_bonds(const Points& points, SurfaceCorrection surface,
                                    const BondSetting& setting, const Communicator& ranks,
                                    PartBonds which = PartBonds::of_owned);

/// The bonds of a body that a part has, with the weights of make_bonds; bonds on several ranks are
/// the same there to the last bit (agree_on_kinds). Collective.
/// @throws std::logic_error if the part's ghosts don't reach as far as reach_of_bonds
[[nodiscard]] Bonds make_bonds(const Part& part, SurfaceCorrection surface,
                               const BondSetting& setting, const Communicator& ranks, int threads,
                               PartBonds which = PartBonds::of_owned);

/// Number of bonds of the whole body that have a weight, each counted once. Collective.
/// @param points of the rank
[[nodiscard]] GlobalIndex count_bonds(const Points& points, const Bonds& bonds,
                                      const Communicator& ranks);

/// Number of interactions of one kind in the whole body, each counted once. Collective.
/// @param here counts all interactions of owned points and their images
[[nodiscard]] GlobalIndex count_interactions(const Points& points, const InteractionCount& here,
                                             const Communicator& ranks);

}  // namespace peristat
