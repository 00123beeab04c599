#pragma once

#include <span>
#include <vector>

#include "assembly/convolutions/lattice_springs.hpp"
#include "src/geometry/lattice_box.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// What is left to points of their neighbours, with integrities q of points:
///
///   weight_i = q_i sum_j q_j w_ij [m6],   count_i = q_i sum_j q_j.
struct NeighbourSums {
  std::vector<double> weight, count;
};

[[nodiscard]] NeighbourSums neighbour_sums(const Bonds& bonds, std::span<const double> integrity);

/// Of a lattice, by convolutions.
/// @param micromodulus c of the springs, w = k L / c
[[nodiscard]] NeighbourSums neighbour_sums(const LatticeBox& box,
                                           std::span<const LatticeSpring> springs,
                                           double micromodulus, std::span<const double> integrity,
                                           int threads);

}  // namespace peristat
