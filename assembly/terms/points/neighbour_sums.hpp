#pragma once

#include <span>
#include <vector>

#include "assembly/convolutions/cut_lattice.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// What is left to points of their neighbours, with integrities q of points:
///
///   weight_i = q_i sum_j q_j w_ij [m6],   count_i = q_i sum_j q_j,
///
/// of a body with images (see Images) half of w_ij where one of the two is one, and nothing where
/// both are.
struct NeighbourSums {
  std::vector<double> weight, count;
};

[[nodiscard]] NeighbourSums neighbour_sums(const Bonds& bonds, std::span<const double> integrity);

/// Of a lattice, by convolutions.
/// @param micromodulus c of the springs, w = k L / c
/// @param own points that are no images, the first ones
[[nodiscard]] NeighbourSums neighbour_sums(const CutLattice& box,
                                           std::span<const LatticeSpring> springs,
                                           double micromodulus, std::span<const double> integrity,
                                           std::size_t own, int threads);

}  // namespace peristat
