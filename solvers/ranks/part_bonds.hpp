#pragma once

#include "assembly/terms/term.hpp"
#include "src/core/communicator.hpp"
#include "src/geometry/part.hpp"
#include "src/materials/quadrature.hpp"

namespace peristat {

/// Which bonds of a body a part has. A bond of points of two ranks is on both.
enum class PartBonds {
  of_owned,          ///< every one with a point that its rank owns
  among_neighbours,  ///< and those between ghosts, which triangles and tetrahedra stand on
  of_neighbours      ///< all of its points and of their neighbours, which have states of their own
};

/// How far ghosts must reach for the bonds of a part [m]: as far as these, once more where these
/// are of neighbours, and where a surface correction asks for what the neighbours of a point see. A
/// call that all ranks make.
/// @param points those of the rank, without ghosts or with them
[[nodiscard]] double reach_of_bonds(const Points& points, SurfaceCorrection surface,
                                    const BondSetting& setting, const Communicator& ranks,
                                    PartBonds which = PartBonds::of_owned);

/// The bonds of a body that a part has, with the weights of make_bonds; those that several ranks
/// have are the same there to the last bit (agree_on_kinds). A call that all make.
/// @throws std::logic_error if the part's ghosts don't reach as far as reach_of_bonds
[[nodiscard]] Bonds make_bonds(const Part& part, SurfaceCorrection surface,
                               const BondSetting& setting, const Communicator& ranks, int threads,
                               PartBonds which = PartBonds::of_owned);

/// Bonds of the whole body that have a weight, each counted once.
/// @param points of the rank
[[nodiscard]] GlobalIndex count_bonds(const Points& points, const Bonds& bonds,
                                      const Communicator& ranks);

/// Interactions of the whole body of a kind, each counted once.
/// @param here all that owned points and their images take part in
[[nodiscard]] GlobalIndex count_interactions(const Points& points, const InteractionCount& here,
                                             const Communicator& ranks);

}  // namespace peristat
