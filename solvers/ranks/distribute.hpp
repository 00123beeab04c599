#pragma once

#include "src/core/communicator.hpp"
#include "src/geometry/part.hpp"

namespace peristat {

/// Distributes a body that every rank has made a slab of: parts whose points have about as many
/// neighbours together, by `partition`, each with its ghosts. A rank may get no point.
/// @param horizon of the neighbours that are counted [m]
/// @param reach   within which ghosts are wanted [m]
/// @param images  see Part::images: what an image of a point is near, the point is near
[[nodiscard]] Part distribute(Part slab, double horizon, double reach, const Communicator& ranks,
                              int threads, std::vector<ImageKind> images = {});

/// The points of a part that its rank owns, and all others that stand within a distance of one of
/// them. A rank asks those for ghosts whose points' boxes are within that distance of its own.
[[nodiscard]] Part with_ghosts(Part part, double reach, const Communicator& ranks,
                               std::vector<ImageKind> images = {});

}  // namespace peristat
