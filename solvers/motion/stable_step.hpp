#pragma once

#include <span>

#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"

namespace peristat {

/// Largest eigenvalue of M^-1 K, the square of the highest angular frequency [1/s2]. Where
/// interactions are moved to their positive semidefinite part it is not smaller than that of K.
struct Stiffness {
  /// p max_i lambda_max(K_ii) / m_i with the diagonal blocks of points: no eigenvalue is larger.
  /// For p points of an interaction, u.H u <= p sum_a u_a.H_aa u_a by Cauchy and Schwarz.
  double bound = 0.0;
  /// The eigenvalue as far as it is known: the bound, or what Lanczos' method has found and a
  /// hundredth more.
  double eigenvalue = 0.0;

  /// Below this step the explicit scheme is stable, 2 / sqrt(eigenvalue) [s]; infinite without any
  /// stiffness.
  [[nodiscard]] double stable_step() const;
};

/// @param tangent of a state, its interactions projected
/// @param mass per degree of freedom [kg]
/// @param most_points of an interaction: 2 of a bond, 4 of a tetrahedron
[[nodiscard]] Stiffness bound_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                        std::span<const double> mass, int most_points);

/// Finds the eigenvalue, too, with products of the tangent.
[[nodiscard]] Stiffness find_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                       std::span<const double> mass, int most_points);

}  // namespace peristat
