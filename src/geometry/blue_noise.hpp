#pragma once

#include "src/geometry/lattice.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Random points in a lattice's body with about the same distance from their neighbours, one per
/// h^dimension of the body, with h the lattice's spacing or, with refinements, that of the
/// SpacingField: Poisson-disk places, moved `lloyd_steps` times to the centroids of their Voronoi
/// cells (Lloyd 1982). A point has the volume of its Voronoi cell's part in the body and stands at
/// that part's centroid, so that sum V and sum V X are those of the body; if that centroid lies
/// outside the body, it stands at the cell's place. The points belong to no lattice. Refined points
/// have their mean spacing as Points::spacing.
/// @throws InputError ("shapes") if the body has not half a cell's volume, ("refinements[0].shape")
///         for a region without effect
[[nodiscard]] Points make_blue_noise_points(const Lattice& lattice);

}  // namespace peristat
