#pragma once

#include <filesystem>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// File of neighbours and their shares, and the limits of their distance.
struct NeighbourFile {
  std::filesystem::path file;
  double horizon = 0.0;        ///< [m]
  double cross_section = 1.0;  ///< 1D: area [m2]; 2D: thickness [m]; 3D: 1
};

/// Reads pairs of neighbours and how much of their volumes counts (external grids of [GPMB] option
/// I, whose neighbour areas are w_ij V_j / thickness).
///
/// The first line that is neither empty nor a comment (#) names the columns: `i`, `j`, `w_ij`, the
/// share of point j's volume that i counts, and optionally `w_ji`; separated by commas or blanks.
/// Points are numbered from 1. Each pair has one row, with w_ji = w_ij if that is not given; or,
/// without a column `w_ji`, every pair has two rows, one for each direction. Shares are 0 to 1. A
/// neighbour may lie beyond the horizon by half the diagonal of its square or cubic cell, so that a
/// part of its cell lies within.
/// @param points in the order of their numbers
/// @return ascending by i and then j, numbered from 0
/// @throws InputError with "FILE:LINE" as its place for an unknown column, a number that is no
///         point's, a point that is its own neighbour, a pair given twice or in one direction while
///         others are given in both, a share that is not finite or not from 0 to 1, or 0 both ways,
///         and points too far apart; with "neighbours" for a file that can't be read or has no rows
[[nodiscard]] std::vector<NeighbourShares> read_neighbours(const NeighbourFile& from,
                                                           const Points& points);

}  // namespace peristat
