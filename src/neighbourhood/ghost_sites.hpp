#pragma once

#include <vector>

#include "src/geometry/lattice.hpp"
#include "src/geometry/lattice_frame.hpp"

namespace peristat {

/// Places of a lattice that hold no point.
struct GhostSites {
  std::vector<Cell> cell;         ///< ascending
  std::vector<double> reference;  ///< positions, count x dimension, row major [m]

  [[nodiscard]] Index count() const { return static_cast<Index>(cell.size()); }
};

/// Returns the empty places of a lattice within a radius of one of its points, layers' points
/// included: with them every point has the neighbours that it would have in an unbounded lattice.
/// On a perturbed lattice each place is shifted, too, by up to `perturbation` spacings along each
/// of the lattice's axes. The shift depends on the seed and the place alone, not on holes in the
/// body. (The body's own shifts are drawn one after another, so that a ghost does not stand where a
/// larger body of the same seed has its point.) Shifted corners of cells (`cell_perturbation`)
/// shift no ghosts.
/// @param points those of make_points for the lattice, in any order; images hold their places, but
///        need no ghosts
/// @param radius closed, with the tolerance of a horizon [m]
/// @throws InputError ("radius") if it can't be used or if points and ghosts can't be numbered
[[nodiscard]] GhostSites ghost_sites(const Lattice& lattice, const Points& points, double radius);

/// Distance by which the points of a part of a body must reach beyond the balls whose ghost sites
/// are wanted, so that no place that holds a point farther away can have a ghost in such a ball:
/// the sum of the largest distances of points and of ghosts from their places [m].
/// @param points of the body, or of one of its parts: then the largest of all parts counts
[[nodiscard]] double reach_beyond_balls(const Lattice& lattice, const Points& points);

}  // namespace peristat
