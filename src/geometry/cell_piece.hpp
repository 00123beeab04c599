#pragma once

#include "src/geometry/lattice_frame.hpp"
#include "src/geometry/solid.hpp"

namespace peristat {

/// What a region has of a lattice's cell.
struct CellPiece {
  double share = 0.0;      ///< of the cell's volume, 0 to 1
  Coordinates centroid{};  ///< [m]
};

/// Share and centroid by exact chords along the lattice's first axis, integrated across it by an
/// adaptive Gauss rule between the heights at which chords begin, end or kink. In 1D, between
/// planes along the lattice, and in 2D where no two shapes' boundaries cross in the cell, to
/// round-off or 1e-9 of a cell; a corner where two cross, or of a layer on a turned lattice, to
/// 1e-5 of a cell; in 3D to 1e-5 of a cell. Shares within those of 0 or 1 are 0 or 1, and a whole
/// cell's centroid is its place to the last bit.
[[nodiscard]] CellPiece piece_of(const LatticeFrame& frame, const Cell& cell, const Region& region);

}  // namespace peristat
