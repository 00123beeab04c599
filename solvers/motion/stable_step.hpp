#pragma once

#include <span>

#include "assembly/energy/energy.hpp"
#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"

namespace peristat {

/// Largest eigenvalue of M^-1 K, the square of the highest angular frequency [1/s2]. Where
/// interactions are moved to their positive semidefinite part it is not smaller than that of K.
struct Stiffness {
  /// p max_i lambda_max(K_ii) / m_i with the diagonal blocks of points: no eigenvalue is larger.
  /// For p points of an interaction, u.H u <= p sum_a u_a.H_aa u_a by Cauchy and Schwarz. Where no
  /// p is known, Gershgorin's: the largest sum of the absolute entries of a row, over its mass.
  double bound = 0.0;
  /// The eigenvalue as far as it is known: the bound, or what Lanczos' method has found and a
  /// hundredth more.
  double eigenvalue = 0.0;

  /// Below this step the explicit scheme is stable, 2 / sqrt(eigenvalue) [s]; infinite without any
  /// stiffness.
  [[nodiscard]] double stable_step() const;
};

/// Of the tangent that an eigenvalue is found of: interactions one by one are projected,
/// convolutions have their own, since what stands in for it has others.
[[nodiscard]] double projection_for_stiffness(const Energy& energy);

/// @param tangent of a state, with that projection
/// @param mass per degree of freedom [kg]
/// @param most_points of an interaction: 2 of a bond, 4 of a tetrahedron; 0: not known
[[nodiscard]] Stiffness bound_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                        std::span<const double> mass, int most_points);

/// Finds the eigenvalue, too, with products of the tangent; of one that is not symmetric by powers
/// of it.
[[nodiscard]] Stiffness find_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                       std::span<const double> mass, int most_points);

}  // namespace peristat
