#pragma once

#include <span>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Degrees to which weights may be exact. Lower ones are not exact for displacements that are
/// quadratic in place: their dilatation needs degree 3, their forces degree 4.
inline constexpr int least_exact_degree = 4, most_exact_degree = 8;

/// Largest accepted |B omega - g|, in the scale of the unit ball.
inline constexpr double exactness_tolerance = 1e-11;

/// Neighbours of points, in both directions. There may be more positions than points: those of
/// points that are neighbours alone.
struct NeighbourLists {
  std::span<const Offset> offset;     ///< points + 1
  std::span<const Index> neighbour;   ///< of each point, in any order; never the point itself
  std::span<const double> reference;  ///< positions, all x dimension, row major [m]
  std::span<const char> is_asked{};   ///< per point: its weights are wanted; empty: all are
};

/// Weights of neighbours that integrate over the ball around a point.
struct OptimisedWeights {
  std::vector<double> weight;     ///< per directed neighbour, in the caller's order [m^dimension]
  double largest_residual = 0.0;  ///< max |B omega - g|, in the scale of the unit ball
  Index negative = 0;             ///< number of weights below 0
  double lowest = 0.0;            ///< the lowest weight [m^dimension]
  Index lowered = 0;              ///< points whose weights are exact to a lower degree than asked
  Index solves = 0;               ///< points that were solved for: one on a lattice
};

/// Weights omega_j of least sum of squares that integrate xi^alpha / |xi|^3 exactly over the ball
/// |xi| <= horizon,
///
///   sum_j omega_j xi_j^alpha / |xi_j|^3 = int xi^alpha / |xi|^3 dxi,
///
/// for all monomials of degrees 2 to `degree` in 2D and 1 to `degree` in 3D: lower ones have no
/// integral (Trask, You, Yu, Parks, Comput. Methods Appl. Mech. Eng. 343 (2019) 151-165). With s =
/// xi / horizon and B_aj = s_j^a / |s_j|^3 they are horizon^dimension B^T y with B B^T y = g,
/// solved by Cholesky, or without the eigenvalues below 1e-11 of the largest. If the neighbours
/// don't allow it, the degree is lowered, down to least_exact_degree. Weights may be negative, and
/// are no volumes: their sum is not that of the ball.
/// @param dimension 2 or 3
/// @param arms of one point: xi = x_j - x_i, count x dimension, row major [m]
/// @throws InputError ("degree", "horizon") if the degree is not allowed or no weights are exact
[[nodiscard]] std::vector<double> optimised_weights(int dimension, double horizon, int degree,
                                                    std::span<const double> arms);

/// The same for many points. Points whose arms agree to 1e-12 of the horizon share one solution,
/// whatever the order of their neighbours. The result does not depend on the number of threads.
/// @throws InputError that gives the place of the first point without such weights
[[nodiscard]] OptimisedWeights optimised_weights(int dimension, double horizon, int degree,
                                                 const NeighbourLists& neighbours, int threads);

}  // namespace peristat
