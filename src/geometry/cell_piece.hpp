#pragma once

#include "src/geometry/lattice_frame.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// Part of a lattice's cell that lies in a region.
struct CellPiece {
  double share = 0.0;      ///< of the cell's volume, 0 to 1
  Coordinates centroid{};  ///< [m]
};

/// Share and centroid by exact chords along the lattice's first axis, integrated across it by an
/// adaptive Gauss rule between the heights at which chords begin, end or kink. In 1D, between
/// planes along the lattice, and in 2D where no two shapes' boundaries cross in the cell, they are
/// exact to round-off or 1e-9 of a cell. A corner where two boundaries cross, or of a layer on a
/// turned lattice, is exact to 1e-5 of a cell, as are cells in 3D. A share within 1e-9 (3D: 1e-6)
/// of 0 or 1 is set to 0 or 1, and a whole cell's centroid is its place to the last bit.
[[nodiscard]] CellPiece piece_of(const LatticeFrame& frame, const Cell& cell, const Region& region);

}  // namespace peristat
