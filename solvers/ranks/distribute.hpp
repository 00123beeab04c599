#pragma once

#include "src/geometry/part.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Distributes a body of which every rank has made a slab: the parts have about equal total numbers
/// of neighbours, by `partition`, each with its ghosts. A rank may get no point. Collective.
/// @param horizon for counting neighbours [m]
/// @param reach   distance within which ghosts are needed [m]
/// @param images  see Part::images: points near an image of a point count as near that point
[[nodiscard]] Part distribute(Part slab, double horizon, double reach, const Communicator& ranks,
                              int threads, std::vector<ImageKind> images = {});

/// Adds ghosts to a part: all points of other ranks within a distance of a point that its rank
/// owns. Ranks offer points to those whose points' bounding boxes are within that distance of their
/// own. Collective.
[[nodiscard]] Part with_ghosts(Part part, double reach, const Communicator& ranks,
                               std::vector<ImageKind> images = {});

}  // namespace peristat
