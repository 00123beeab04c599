#pragma once

#include "assembly/terms/collocation/collocation_network.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// A network, and statistics of its quadrature.
struct MadeCollocationNetwork {
  CollocationNetwork network;
  Index negative = 0;   ///< weights below 0
  double lowest = 0.0;  ///< the lowest one over the volume of a cell
  Index lowered = 0;    ///< points whose weights are exact to a lower degree than asked
  Index solves = 0;     ///< points whose weights were solved for
};

/// Neighbourhoods with optimised weights (see optimised_weights) of balls that the points and their
/// ghosts fill. Neighbours without a bond count as missing: ghosts, and points that cracks have cut
/// off. On a part of a body the points that its rank owns and their neighbours have a
/// neighbourhood, others none.
/// @param bonds uncut bonds
/// @throws InputError as optimised_weights does
[[nodiscard]] MadeCollocationNetwork make_collocation_network(const Points& points,
                                                              const Bonds& bonds, double horizon,
                                                              int degree, int threads);

/// The same operator between adjacent points of a lattice, along an axis or a diagonal of a face,
/// with the shares that make forces of linear displacements right:
///
///   1 / (8 h^2), 1 / (16 h^2) in 2D,   1 / (30 h^2) both in 3D.
///
/// It replaces the operator in approximate solves. On perturbed lattices it is that of the lattice
/// without the perturbation: between moved points the shares of the lattice would give wrong forces
/// of linear displacements.
/// @throws std::logic_error for points on no lattice of squares or cubes
[[nodiscard]] CollocationNetwork make_local_network(const Points& points, const Bonds& bonds);

}  // namespace peristat
