#pragma once

#include "assembly/terms/collocation/collocation_network.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// A network, and what is to be told of its quadrature.
struct MadeCollocationNetwork {
  CollocationNetwork network;
  Index negative = 0;   ///< weights below 0
  double lowest = 0.0;  ///< the lowest one over the volume of a cell
  Index lowered = 0;    ///< points whose weights are exact to a lower degree than asked
  Index solves = 0;     ///< points whose weights were solved for
};

/// Neighbourhoods with optimised weights (see optimised_weights) of balls that the points and their
/// ghosts fill. What is no bond of the body is missing: ghosts, and what cracks have cut off. In a
/// part of a body points that its rank owns and their neighbours have one, others none.
/// @param bonds that are left
/// @throws InputError as optimised_weights does
[[nodiscard]] MadeCollocationNetwork make_collocation_network(const Points& points,
                                                              const Bonds& bonds, double horizon,
                                                              int degree, int threads);

/// The same operator between the points of a lattice that are next to one another along an axis or
/// a diagonal of a face, with the shares that make forces of linear displacements right:
///
///   1 / (8 h^2), 1 / (16 h^2) in 2D,   1 / (30 h^2) both in 3D.
///
/// It stands in for the operator where a system is to be solved nearly. On perturbed lattices it is
/// that of the lattice without the perturbation: with the shares of the lattice between points that
/// are moved forces of linear displacements would be wrong.
/// @throws std::logic_error for points on no lattice of squares or cubes
[[nodiscard]] CollocationNetwork make_local_network(const Points& points, const Bonds& bonds);

}  // namespace peristat
