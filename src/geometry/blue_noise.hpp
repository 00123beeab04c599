#pragma once

#include <cstdint>
#include <vector>

#include "src/geometry/lattice.hpp"
#include "src/geometry/points.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// Returns `count` random places in a body that keep a distance from one another. Darts are thrown
/// at the body's box; a dart stays if it hits the body and no place lies within the distance. The
/// distance begins at the spacing and falls by a factor of 1 - 1/(100 count) with every dart that
/// is too near (McCool and Fiume 1992), so that the count is reached in the end: at 0.7 spacings in
/// 2D and 0.8 in 3D, if the spacing is the mean one. The seed alone determines the result.
/// @param spacing of a lattice of as many points [m]
[[nodiscard]] std::vector<Coordinates> poisson_disk_places(const Solid& body, std::size_t count,
                                                           double spacing, std::uint64_t seed);

/// Random points in a lattice's body with about the same distance from their neighbours, one per
/// spacing^dimension of the body: Poisson-disk places, moved `lloyd_steps` times to the centroids
/// of their Voronoi cells (Lloyd 1982). A point has the volume of its Voronoi cell's part in the
/// body and stands at that part's centroid, so that sum V and sum V X are those of the body; if
/// that centroid lies outside the body, it stands at the cell's place. The points belong to no
/// lattice.
/// @throws InputError ("shapes") if the body has not half a cell's volume
[[nodiscard]] Points make_blue_noise_points(const Lattice& lattice);

}  // namespace peristat
