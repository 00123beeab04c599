#pragma once

#include <span>

#include "assembly/energy/energy.hpp"
#include "assembly/operators/tangent_operator.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Largest eigenvalue of M^-1 K, the square of the highest angular frequency [1/s2]. With
/// interactions projected to their positive semidefinite part it is not smaller than that of K.
struct Stiffness {
  /// p max_i lambda_max(K_ii) / m_i with the diagonal blocks of points: no eigenvalue is larger.
  /// For interactions of p points, u.H u <= p sum_a u_a.H_aa u_a by Cauchy and Schwarz. If p is not
  /// known, Gershgorin's bound: the largest sum of the absolute entries of a row, over its mass.
  double bound = 0.0;
  /// Best known upper estimate: the bound, or if smaller the result of Lanczos' method and a
  /// hundredth more (of the power method and a twentieth more).
  double eigenvalue = 0.0;

  /// Largest stable step of the explicit scheme, 2 / sqrt(eigenvalue) [s]; infinite without any
  /// stiffness.
  [[nodiscard]] double stable_step() const;
};

/// Projection of the tangent whose eigenvalue is found: 1 where interactions are projected one by
/// one, 0 for convolutions, whose projected tangent has other eigenvalues.
[[nodiscard]] double projection_for_stiffness(const Energy& energy);

/// Collective.
/// @param tangent of a state, with that projection; of a part, if the body is partitioned
/// @param mass per degree of freedom [kg]
/// @param most_points points per interaction: 2 of a bond, 4 of a tetrahedron; 0: not known
[[nodiscard]] Stiffness bound_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                        std::span<const double> mass, int most_points,
                                        const IndexMap& index_map = whole_body());

/// Also finds the eigenvalue, with products of the tangent: by Lanczos' method, or if the tangent
/// is not symmetric by the power method.
[[nodiscard]] Stiffness find_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                                       std::span<const double> mass, int most_points,
                                       const IndexMap& index_map = whole_body());

}  // namespace peristat
