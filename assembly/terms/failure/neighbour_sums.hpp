#pragma once

#include <span>
#include <vector>

#include "assembly/convolutions/cut_lattice.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Sums over the neighbours that points have left, with integrities q of points:
///
///   weight_i = q_i sum_j q_j w_ij [m6],   count_i = q_i sum_j q_j,
///
/// In a body with images (see Images) w_ij counts half if one of the two points is an image, and
/// not at all if both are.
struct NeighbourSums {
  std::vector<double> weight, count;
};

[[nodiscard]] NeighbourSums neighbour_sums(const Bonds& bonds, std::span<const double> integrity);

/// The same on a lattice, by convolutions.
/// @param micromodulus c of the springs, w = k L / c
/// @param own number of points that are no images; they come first
[[nodiscard]] NeighbourSums neighbour_sums(const CutLattice& box,
                                           std::span<const LatticeSpring> springs,
                                           double micromodulus, std::span<const double> integrity,
                                           std::size_t own, int threads);

}  // namespace peristat
